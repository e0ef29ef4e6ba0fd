#pragma once

#include "base/pose.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe {

class Settings;
class Simulation;
namespace worldio {
struct JsonNode;
}

/// A value in the description of a world: a number, a text, a truth value, a list, or named values.
class Setting {
 public:
  /// Implicit conversions from C++ values.
  ///@{
  Setting(bool value);
  Setting(double value);  ///< throws std::invalid_argument if it is not finite
  Setting(std::int64_t value);
  Setting(std::uint64_t value);
  template <std::integral T>
  Setting(T value)
      : Setting(
            static_cast<std::conditional_t<std::signed_integral<T>, std::int64_t, std::uint64_t>>(value)) {}
  Setting(const char* text);
  Setting(std::string_view text);
  Setting(const std::string& text);
  ///@}
  Setting(const Pose& pose);  ///< m and rad; elements that are 0 are omitted
  /// Named values: an object in JSON.
  Setting(const Settings& values);
  /// A list of values: an array in JSON.
  Setting(const std::vector<Setting>& list);
  Setting(std::initializer_list<Setting> list);  ///< `{0.3, 0.3, 0.2}`

  std::string json() const;  ///< the value as JSON

 private:
  friend class WorldBuilder;
  std::shared_ptr<const worldio::JsonNode> node_;
};

/// Named values under the keys of a world file, whose names include the unit (docs/world-format.md):
///
///     troupe::Settings{{"range_max_m", 2}, {"fov_deg", 90}, {"samples", 9}}
class Settings {
 public:
  /// A key and its value.
  struct Entry {
    std::string_view key;  ///< key of the world file, with its unit: "range_max_m"
    Setting value;         ///< in the unit of the key
  };
  Settings() = default;
  Settings(std::initializer_list<Entry> entries);  ///< calls set() for each entry
  /// Sets a key, and replaces an earlier value of it.
  Settings& set(std::string_view key, const Setting& value);
  Settings& set(const Settings& values);  ///< sets each of these keys
  /// Keys and values, in the order in which they were set.
  const std::vector<std::pair<std::string, Setting>>& entries() const { return entries_; }

 private:
  std::vector<std::pair<std::string, Setting>> entries_;
};

/// Builds a world in a program: types of bodies, and bodies.
///
///     troupe::WorldBuilder world;
///     world.set("seed", 7);
///     world.wall({-3, 2}, {3, 2});
///     const troupe::Settings beams{{"range_max_m", 2}, {"fov_deg", 90}, {"samples", 9}};
///     world.type("bot")
///         .size(0.3, 0.3, 0.2)
///         .drive("diff", {{"velocity_max_x_mps", 0.5}})
///         .sensor("ir", "ranger", {{"transducers", {beams}}})
///         .controller("wander");
///     for (int i = 0; i < 10; ++i) world.add("r" + std::to_string(i), "bot", {.x = 0.5 * i});
///     troupe::Simulation simulation(world);
///
/// It has the content and the keys of a JSON world file, which docs/world-format.md and `troupe describe`
/// document; json() returns that file. Making the simulation reports all errors at once, as
/// `world.json:7: error: /types/bot/drive/kind: unknown drive ...`, at the lines of json().
class WorldBuilder {
 public:
  /// A type of bodies, made by WorldBuilder::type(), which owns it.
  class Type {
    struct Key {
      explicit Key() = default;
    };

   public:
    Type(Key, std::string_view name) : name_(name) {}  ///< only for WorldBuilder
    Type(const Type&) = delete;
    Type& operator=(const Type&) = delete;

    Type& size(double x, double y, double z);  ///< a box on the floor, centred on the origin, m
    Type& color(const Setting& color);         ///< "SteelBlue", or {red, green, blue} from 0 to 1
    /// The drive: "diff", "omni", "car", ... with the parameters of that kind.
    Type& drive(std::string_view kind, const Settings& parameters = {});
    /// Adds a sensor: its name in the type, its kind, its parameters, and its pose in the body's frame.
    Type& sensor(std::string_view name, std::string_view kind, const Settings& parameters = {},
                 const Pose& pose = {});
    /// Adds another device (light, gripper, power pack, ...): name, kind, parameters, pose in the body's
    /// frame.
    Type& device(std::string_view name, std::string_view kind, const Settings& parameters = {},
                 const Pose& pose = {});
    /// The controller. Without one, the program commands the robots.
    Type& controller(std::string_view kind, const Settings& parameters = {});
    /// Sets any other key of a type.
    Type& set(std::string_view key, const Setting& value);

   private:
    friend class WorldBuilder;
    std::string name_;
    Settings values_;
    std::vector<Setting> sensors_, devices_;
  };

  /// name: the file name in errors and, without .json, the title of the world; relative paths (bitmaps) are
  /// resolved from its folder.
  explicit WorldBuilder(std::filesystem::path name = "world.json");

  /// Sets a key of the top level: "seed", "tick_s", "bounds_m", "stop_when", ...
  WorldBuilder& set(std::string_view key, const Setting& value);
  /// The type of this name. The first call makes it.
  Type& type(std::string_view name);
  /// Adds a body, at a pose in the world's frame, m and rad; `more`: other keys of a model.
  WorldBuilder& add(std::string_view name, std::string_view type, const Pose& pose,
                    const Settings& more = {});
  /// Adds bodies NAME0, NAME1, ... that a rule places; `more`: other keys of a population ("reserve",
  /// "color").
  WorldBuilder& population(std::string_view name, std::string_view type, std::size_t count,
                           const Settings& place, const Settings& more = {});
  /// Adds a straight wall between two points, m, with a type of its own and the name `wall1`, `wall2`, ...
  /// Throws std::invalid_argument if the points are equal.
  WorldBuilder& wall(const Vec2& from, const Vec2& to, double thickness = 0.1, double height = 0.5);
  /// Adds walls from an image, stretched to x by y metres; `more`: other keys of a floor plan.
  WorldBuilder& floorplan(std::string_view name, const std::filesystem::path& bitmap, double x, double y,
                          double height = 0.5, const Settings& more = {});

  const std::filesystem::path& name() const { return name_; }  ///< name given to the constructor
  /// The world as a JSON file for `troupe run`, with one line per body or sensor. Throws std::runtime_error
  /// for text that is not UTF-8, as does making a simulation from it.
  std::string json() const;

 private:
  friend class Simulation;
  /// The content of json(); each value refers to its line there, in this file.
  worldio::JsonNode node(std::uint32_t file) const;
  worldio::JsonNode unplaced() const;
  std::filesystem::path name_;
  Settings values_;
  std::deque<Type> types_;  // deque: references from type() stay valid
  std::vector<Setting> floorplans_, models_, populations_;
  std::size_t walls_ = 0;
};

}  // namespace troupe
