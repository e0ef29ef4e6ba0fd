#pragma once

#include "base/pose.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

/// An action that a person or a program applies to a running world between two ticks (docs/live.md). It is
/// plain data: names, and numbers in SI units.
struct Act {
  /// The kind of action.
  enum class Kind : std::uint8_t {
    move,     ///< places a body at `pose`, if that pose is free
    speed,    ///< commands `speed` to a robot, once
    hold,     ///< commands `speed` to a robot before every tick, overriding its controller, until `release`
    release,  ///< ends a `hold`: the robot follows the commands of its controller again
    command,  ///< sets fields of the command of `device` to `values`
    add,      ///< spawns the next body of the reserve of population `whom` at `pose`
    remove,   ///< removes a body from the world
    disable,  ///< stops the devices, controllers and drive of a body
    enable,   ///< lets a disabled body run again
    set,      ///< changes the parameters in `setting` for all bodies of the type `whom`
  };
  Kind kind = Kind::move;  ///< kind of action; its name is in k_acts
  std::string whom;        ///< name of a body; for `add`, of a population; for `set`, of a type
  Pose pose;               ///< for `move` and `add`: new pose of the body, world frame, m and rad
  /// For `speed` and `hold`: the speeds [forward, left, turn], m/s and rad/s, body frame. For a car, `turn`
  /// is the steering angle, rad.
  std::array<double, 3> speed{};
  std::string device;  ///< for `command`: name of the device
  /// For `command`: the fields of the device's command struct to set. Each has a name, and one number per
  /// column.
  std::vector<std::pair<std::string, std::vector<double>>> values;
  /// For `set`: JSON text with the new values, as Simulation::set() takes it. Example:
  /// `{"drive": {"velocity_max_x_mps": 0.5}}`.
  std::string setting;

  friend bool operator==(const Act&, const Act&) = default;
};
/// The names of the actions in files and messages, in the order of Act::Kind.
inline constexpr std::array<std::string_view, 10> k_acts{"move", "speed",  "hold",    "release", "command",
                                                         "add",  "remove", "disable", "enable",  "set"};

}  // namespace troupe::engine
