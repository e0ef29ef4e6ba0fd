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

/// A value of the world file: a number, a text, a truth value, a list, or named values (an object in JSON).
class Setting {
 public:
  /// Converts a C++ value to a value of the world file. The conversions are implicit, so that values can be
  /// written directly in Settings. Integers of all types keep their exact values.
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
  /// A pose, m and rad: the named values x_m, y_m, z_m and heading_rad, without those that are 0. Throws
  /// std::invalid_argument if a number is not finite.
  Setting(const Pose& pose);
  /// Named values: an object in JSON.
  Setting(const Settings& values);
  /// A list of values: an array in JSON.
  Setting(const std::vector<Setting>& list);
  Setting(std::initializer_list<Setting> list);  ///< a list, such as `{0.3, 0.3, 0.2}`

  std::string json() const;  ///< the value as JSON text, on one line

 private:
  friend class WorldBuilder;
  std::shared_ptr<const worldio::JsonNode> node_;
};

/// Named values. The names are keys of the world file (docs/world-format.md). A key contains the unit of its
/// value:
///
///     troupe::Settings{{"range_max_m", 2}, {"fov_deg", 90}, {"samples", 9}}
class Settings {
 public:
  /// A key and its value.
  struct Entry {
    std::string_view key;  ///< key of the world file: "range_max_m"
    Setting value;         ///< value in the unit that the key states
  };
  Settings() = default;
  /// Calls set() for each entry. If several entries have the same key, the last one counts.
  Settings(std::initializer_list<Entry> entries);
  /// Sets the value of a key; replaces an earlier value of the same key.
  Settings& set(std::string_view key, const Setting& value);
  Settings& set(const Settings& values);  ///< sets each key of `values` to its value in `values`
  /// Keys and values, in the order in which the keys were set for the first time.
  const std::vector<std::pair<std::string, Setting>>& entries() const { return entries_; }

 private:
  std::vector<std::pair<std::string, Setting>> entries_;
};

/// Builds a world in a program: types of bodies, and bodies. A type states the properties that bodies of the
/// same construction share; a robot is a body whose type has a drive.
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
/// The names and values are those of a JSON world file, which docs/world-format.md and `troupe describe`
/// document; json() returns this file as text. This class does not check whether names and values are
/// allowed, except that a number that is not finite throws std::invalid_argument. The constructor of
/// Simulation checks them: it throws InputError, whose text lists all errors, each as `world.json:7: error:
/// /types/bot/drive/kind: unknown drive ...`, with the line numbers of json().
class WorldBuilder {
 public:
  /// A type: the shape, drive, sensors and other properties that bodies of the same construction share. Made
  /// by WorldBuilder::type(), and valid as long as the WorldBuilder exists. All functions return *this.
  class Type {
    struct Key {
      explicit Key() = default;
    };

   public:
    Type(Key, std::string_view name) : name_(name) {}  ///< only WorldBuilder can call this
    Type(const Type&) = delete;
    Type& operator=(const Type&) = delete;

    /// Makes the body a box with these edge lengths along x, y and z, m. The base of the box is centred on
    /// the origin of the body.
    Type& size(double x, double y, double z);
    /// Sets the colour: a name, "SteelBlue", or {red, green, blue}, each from 0 to 1.
    Type& color(const Setting& color);
    /// Sets the drive, which replaces an earlier drive of the type. kind: "diff", "omni", "car", ...;
    /// parameters: the parameters of this kind of drive.
    Type& drive(std::string_view kind, const Settings& parameters = {});
    /// Adds a sensor. name: name of the sensor, unique in the type; kind: "ranger", "bumper", ...;
    /// parameters: the parameters of this kind of sensor; pose: pose of the sensor in the body frame, m and
    /// rad.
    Type& sensor(std::string_view name, std::string_view kind, const Settings& parameters = {},
                 const Pose& pose = {});
    /// Adds a device that is not a sensor (light, gripper, power pack, ...). The parameters are as in
    /// sensor().
    Type& device(std::string_view name, std::string_view kind, const Settings& parameters = {},
                 const Pose& pose = {});
    /// Sets the controller (the code that commands a robot) that runs on each robot of the type. It replaces
    /// an earlier controller. kind: "wander", ...; parameters: those of this kind of controller. Robots
    /// without a controller do only what the program commands.
    Type& controller(std::string_view kind, const Settings& parameters = {});
    /// Sets any key that a type can have in the world file, in place of an earlier value of the key. Do not
    /// set "sensors" of a type that also gets sensors from sensor(), nor "devices" together with device():
    /// the key would occur twice, and the constructor of Simulation reports this as an error.
    Type& set(std::string_view key, const Setting& value);

   private:
    friend class WorldBuilder;
    std::string name_;
    Settings values_;
    std::vector<Setting> sensors_, devices_;
  };

  /// name: a name that is used in place of a file name. Errors begin with the name, its stem is the title of
  /// the world, and relative paths of bitmaps are resolved from its folder. `.json` is appended if the name
  /// has another ending.
  explicit WorldBuilder(std::filesystem::path name = "world.json");

  /// Sets a key of the top level of the world file, in place of an earlier value: "seed", "tick_s",
  /// "bounds_m", "stop_when", ...
  WorldBuilder& set(std::string_view key, const Setting& value);
  /// Returns the type of this name; the first call with this name creates it. The reference stays valid when
  /// further types are created.
  Type& type(std::string_view name);
  /// Adds a body named `name` of a type, at a pose in the world frame, m and rad. more: further keys that a
  /// model can have in the world file.
  WorldBuilder& add(std::string_view name, std::string_view type, const Pose& pose,
                    const Settings& more = {});
  /// Adds `count` bodies of a type with the names NAME0, NAME1, ... (NAME is `name`). place: the placement
  /// rule, as under "place" in the world file, such as {{"rule", "uniform"}, ...}. more: further keys that a
  /// population has in the world file, such as "color", or "reserve", the number of further bodies that can
  /// be added while the world runs.
  WorldBuilder& population(std::string_view name, std::string_view type, std::size_t count,
                           const Settings& place, const Settings& more = {});
  /// Adds a straight wall between two points in the world frame; points, thickness and height in m. Each call
  /// adds a type and a body of this type, both with the name `wall1`, `wall2`, ... in the order of the calls.
  /// Throws std::invalid_argument if the points are equal or a number is not finite.
  WorldBuilder& wall(const Vec2& from, const Vec2& to, double thickness = 0.1, double height = 0.5);
  /// Adds the walls of a floor plan: the dark pixels of the image file `bitmap`. The bounding box of these
  /// pixels is scaled to x by y metres. If `more` contains {"margins", "keep"}, the whole image is scaled
  /// instead. height: height of the walls, m. more: further keys that a floor plan has in the world file,
  /// such as "pose", the pose of the centre of the image (by default the origin of the world).
  WorldBuilder& floorplan(std::string_view name, const std::filesystem::path& bitmap, double x, double y,
                          double height = 0.5, const Settings& more = {});

  /// The name given to the constructor, with the ending `.json`.
  const std::filesystem::path& name() const { return name_; }
  /// The text of the JSON world file, which the program `troupe run` can load, with one line per body or
  /// sensor. Throws std::runtime_error if a text in the world is not valid UTF-8. The constructor of
  /// Simulation then throws this error, too.
  std::string json() const;

 private:
  friend class Simulation;
  /// Returns the content of json() as a tree, in which each value refers to its line in json(), for errors.
  /// file: index of the world's name in the list of source files.
  worldio::JsonNode node(std::uint32_t file) const;
  /// Returns the content of json() as a tree. Its line numbers are not those of json(): they only mark the
  /// values that json() writes on several lines.
  worldio::JsonNode unplaced() const;
  std::filesystem::path name_;
  Settings values_;
  std::deque<Type> types_;  // deque: references from type() stay valid
  std::vector<Setting> floorplans_, models_, populations_;
  std::size_t walls_ = 0;
};

}  // namespace troupe
