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

/// A value in the description of a world: a number, a text, true or false, a list, or named values.
class Setting {
 public:
  /// From what C++ says it with.
  ///@{
  Setting(bool value);
  Setting(double value);  ///< throws std::invalid_argument where it is not finite
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
  Setting(const Pose& pose);  ///< m and rad; what is 0 is left out
  /// Named values, as an object of the file.
  Setting(const Settings& values);
  /// As many values, as a list of the file.
  Setting(const std::vector<Setting>& list);
  Setting(std::initializer_list<Setting> list);  ///< `{0.3, 0.3, 0.2}`

  std::string json() const;  ///< the value, in JSON

 private:
  friend class WorldBuilder;
  std::shared_ptr<const worldio::JsonNode> node_;
};

/// Named values, by the keys of a world file, which carry their units (docs/world-format.md):
///
///     troupe::Settings{{"range_max_m", 2}, {"fov_deg", 90}, {"samples", 9}}
class Settings {
 public:
  /// A key and its value.
  struct Entry {
    std::string_view key;  ///< as the file has it, with its unit: "range_max_m"
    Setting value;         ///< in that unit
  };
  Settings() = default;
  Settings(std::initializer_list<Entry> entries);  ///< as if each were set()
  /// Gives a key a value, in place of the one that it had.
  Settings& set(std::string_view key, const Setting& value);
  Settings& set(const Settings& values);  ///< each of these
  /// In their order.
  const std::vector<std::pair<std::string, Setting>>& entries() const { return entries_; }

 private:
  std::vector<std::pair<std::string, Setting>> entries_;
};

/// A world that a program describes: types of bodies, and bodies.
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
/// It says what a world file in JSON says, under the same keys, so docs/world-format.md and `troupe describe`
/// tell what there is; json() is that file. What is wrong comes out when the simulation is made, all at once,
/// as `world.json:7: error: /types/bot/drive/kind: unknown drive ...`, in the lines of json().
class WorldBuilder {
 public:
  /// What bodies share. Of WorldBuilder::type(); belongs to it.
  class Type {
    struct Key {
      explicit Key() = default;
    };

   public:
    Type(Key, std::string_view name) : name_(name) {}  ///< for WorldBuilder
    Type(const Type&) = delete;
    Type& operator=(const Type&) = delete;

    Type& size(double x, double y, double z);  ///< a box on the floor about the origin, m
    Type& color(const Setting& color);         ///< "SteelBlue", or {red, green, blue} from 0 to 1
    /// How it moves: "diff", "omni", "car", ... with the parameters of that kind.
    Type& drive(std::string_view kind, const Settings& parameters = {});
    /// One more sensor: its name in the type, its kind, its parameters, and its pose in the body's frame.
    Type& sensor(std::string_view name, std::string_view kind, const Settings& parameters = {},
                 const Pose& pose = {});
    /// The same of what does something: lights, grippers, power packs, ...
    Type& device(std::string_view name, std::string_view kind, const Settings& parameters = {},
                 const Pose& pose = {});
    /// Who decides for it; none: the program does.
    Type& controller(std::string_view kind, const Settings& parameters = {});
    /// Any other key of a type.
    Type& set(std::string_view key, const Setting& value);

   private:
    friend class WorldBuilder;
    std::string name_;
    Settings values_;
    std::vector<Setting> sensors_, devices_;
  };

  /// name: what findings call it, and, without .json, its title; what it names besides (bitmaps) is found
  /// from its folder.
  explicit WorldBuilder(std::filesystem::path name = "world.json");

  /// A key of the top level: "seed", "tick_s", "bounds_m", "stop_when", ...
  WorldBuilder& set(std::string_view key, const Setting& value);
  /// The type of this name: a new one when it is first asked for.
  Type& type(std::string_view name);
  /// One more body, at a pose in the world's frame, m and rad; `more`: other keys of a model.
  WorldBuilder& add(std::string_view name, std::string_view type, const Pose& pose,
                    const Settings& more = {});
  /// Bodies NAME0, NAME1, ... that a rule places; `more`: other keys of a population ("reserve", "color").
  WorldBuilder& population(std::string_view name, std::string_view type, std::size_t count,
                           const Settings& place, const Settings& more = {});
  /// A straight wall between two points, m, with a type of its own; its name is `wall1`, `wall2`, ... Throws
  /// std::invalid_argument where the two are one point.
  WorldBuilder& wall(const Vec2& from, const Vec2& to, double thickness = 0.1, double height = 0.5);
  /// Walls from an image, stretched to x by y metres; `more`: other keys of a floor plan.
  WorldBuilder& floorplan(std::string_view name, const std::filesystem::path& bitmap, double x, double y,
                          double height = 0.5, const Settings& more = {});

  const std::filesystem::path& name() const { return name_; }  ///< of the world
  /// The world as a file in JSON, a body or a sensor a line, which `troupe run` takes. Throws
  /// std::runtime_error for a text that is no UTF-8, as does the simulation that is made of it.
  std::string json() const;

 private:
  friend class Simulation;
  /// What json() writes, each value at its line there, in this file.
  worldio::JsonNode node(std::uint32_t file) const;
  worldio::JsonNode unplaced() const;
  std::filesystem::path name_;
  Settings values_;
  std::deque<Type> types_;  // deque: they stay where they are
  std::vector<Setting> floorplans_, models_, populations_;
  std::size_t walls_ = 0;
};

}  // namespace troupe
