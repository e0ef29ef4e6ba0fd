#pragma once

#include "base/pose.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
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
/// The functions take the keys and values of a JSON world file, which docs/world-format.md and `troupe
/// describe` document. json() returns the world as the text of such a file. A number that is not finite
/// throws std::invalid_argument. Other mistakes in keys and values are found later, by the constructor of
/// Simulation. It throws InputError, whose text lists all errors. Each error states a line number in the text
/// that json() returns:
///
///     world.json:7: error: /types/bot/drive/kind: unknown drive ...
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
    /// Sets the colour: an X11 name such as "SteelBlue", or {red, green, blue}, each from 0 to 1.
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
    /// Sets any key that a type can have in the world file; replaces an earlier value of the key. Do not use
    /// the key "sensors" in a type that has sensors from sensor(): the key would occur twice, and the
    /// constructor of Simulation would report an error. The same applies to the key "devices" and to
    /// device().
    Type& set(std::string_view key, const Setting& value);

   private:
    friend class WorldBuilder;
    std::string name_;
    Settings values_;
    std::vector<Setting> sensors_, devices_;
  };

  /// Makes a world without bodies. `name` takes the place of the name of a world file: errors begin with it,
  /// its stem is the default title of the world, and paths of images are relative to its folder. If `name`
  /// does not end in `.json`, this ending is appended.
  explicit WorldBuilder(std::filesystem::path name = "world.json");

  /// Sets a key of the top level of the world file, such as "seed", "tick_s", "bounds_m" or "stop_when".
  /// Replaces an earlier value of the key.
  WorldBuilder& set(std::string_view key, const Setting& value);
  /// Returns the type of this name; the first call with this name creates it. The reference stays valid when
  /// further types are created.
  Type& type(std::string_view name);
  /// Adds a body. name: name of the body; type: name of its type; pose: its pose in the world frame, m and
  /// rad; more: further keys of an entry of the list "models" in the world file, such as "color".
  WorldBuilder& add(std::string_view name, std::string_view type, const Pose& pose,
                    const Settings& more = {});
  /// Adds a population: `count` bodies of a type that a rule places. The bodies have the names NAME0, NAME1,
  /// ..., where NAME is `name`. place: the placement rule, the value of the key "place" in the world file,
  /// such as {{"rule", "uniform"}}. more: further keys of an entry of the list "populations" in the world
  /// file, such as "color". The key "reserve" is the number of additional bodies that can enter the world
  /// while it runs.
  WorldBuilder& population(std::string_view name, std::string_view type, std::size_t count,
                           const Settings& place, const Settings& more = {});
  /// Adds a straight wall between two points in the world frame; points, thickness and height in m. Each call
  /// adds a type and a body of this type. Both have the name `wall1` in the first call, `wall2` in the
  /// second, and so on; names of types that exist already are left out. Throws std::invalid_argument, and
  /// adds nothing, if the points are equal or a number is not finite.
  WorldBuilder& wall(const Vec2& from, const Vec2& to, double thickness = 0.1, double height = 0.5);
  /// Adds a floor plan: a body whose walls are the dark pixels of the image file `bitmap`. The bounding box
  /// of the dark pixels is scaled to x by y metres and centred on the origin of the body. If `more` contains
  /// {"margins", "keep"}, the whole image is scaled and centred instead. height: height of the walls, m.
  /// more: further keys of an entry of the list "floorplans" in the world file. The key "pose" is the pose of
  /// the body in the world frame; without it, the body is at the origin.
  WorldBuilder& floorplan(std::string_view name, const std::filesystem::path& bitmap, double x, double y,
                          double height = 0.5, const Settings& more = {});

  /// The name given to the constructor, with `.json` appended if it had another ending.
  const std::filesystem::path& name() const { return name_; }
  /// The text of the JSON world file, which the program `troupe run` can load. Each body, sensor and device
  /// has a line of its own. Throws std::runtime_error if a text in the world is not valid UTF-8. The
  /// constructor of Simulation also throws this error.
  std::string json() const;

 private:
  friend class Simulation;
  /// Returns the content of json() as a tree. Each value of the tree stores its line in json(), for errors.
  /// file: number of the world's name in SourceFiles (base/diagnostics.hpp).
  worldio::JsonNode node(std::uint32_t file) const;
  /// Returns the content of json() as a tree without the line numbers of json(). In this tree, a special line
  /// number marks each value that json() writes on several lines.
  worldio::JsonNode unplaced() const;
  std::filesystem::path name_;
  Settings values_;
  std::deque<Type> types_;                                   // deque: references from type() stay valid
  std::map<std::string, std::size_t, std::less<>> numbers_;  // by name of the type: index into types_
  std::vector<Setting> floorplans_, models_, populations_;
  std::size_t walls_ = 0;
};

}  // namespace troupe
