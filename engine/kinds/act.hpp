#pragma once

#include "base/pose.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

/// An action that a person or a program applies to a running world between two ticks (time steps), with
/// Simulation::act() (docs/live.md). It is plain data: names, and numbers in SI units. Each kind of action
/// uses only some of the members; the others are ignored. If an action is impossible, such as a move to an
/// occupied pose, Simulation::act() throws troupe::ActRefused and changes nothing.
///
/// All bodies of a body type have the same parts, devices (sensors and actuators), drive and controllers. A
/// population is a group of bodies of one type with the names NAME0, NAME1, ... . The reserve of a population
/// consists of the bodies that are not yet in the world but can be spawned later.
struct Act {
  /// The kind of action. A body that an action names must be in the world.
  enum class Kind : std::uint8_t {
    move,  ///< places a body at `pose`, which must be free
    /// gives a robot the command `speed` once; the robot keeps this command until its controller gives the
    /// next one
    speed,
    /// gives a robot the command `speed` before every tick, which overrides the commands of its controller.
    /// The hold ends with `release`, with a reset of the simulation, or when the robot is no longer in the
    /// world.
    hold,
    release,  ///< ends the `hold` of a robot: the robot follows the commands of its controller again
    /// changes the command to `device`, a device of the body `whom`: sets the fields that `values` names; the
    /// other fields of the command do not change. A controller that uses the device may overwrite the
    /// command.
    command,
    /// spawns the next body of the reserve of the population `whom` at `pose`, which must be free
    add,
    remove,   ///< removes a body from the world for good
    disable,  ///< stops the devices, controllers and drive of a body, until the action `enable`
    enable,   ///< ends `disable`, but not a drop-out (a fault that stops the body)
    set,      ///< changes the parameters that `setting` names, for all bodies of the type `whom`
  };
  Kind kind = Kind::move;  ///< kind of action
  std::string whom;        ///< name of a body; for `add`, of a population; for `set`, of a body type
  Pose pose;               ///< for `move` and `add`: new pose of the body, world frame, m and rad
  /// For `speed` and `hold`: the speeds [forward, left, turn], m/s and rad/s, body frame, each from -1e6 to
  /// 1e6. For a drive of kind `car`, `turn` is the steering angle, rad.
  std::array<double, 3> speed{};
  std::string device;  ///< for `command`: name of the device, which must take commands
  /// For `command`: names of fields of the device's command struct, each with its new numbers. A field needs
  /// one number, or one per element if it is an array. All numbers must be finite. Further rules depend on
  /// the type of the field:
  /// - bools: 0 or 1
  /// - integers of 8 or 32 bits: whole numbers within the range of the type
  /// - signed integers of 64 bits: whole numbers from -2^53 to 2^53 - 1
  /// - unsigned integers of 64 bits: whole numbers from 0 to 2^53 - 1
  /// - float: numbers of at most the magnitude of the largest float; they are rounded to float
  std::vector<std::pair<std::string, std::vector<double>>> values;
  /// For `set`: JSON text with the new values of parameters, in the format of Simulation::set(). Example:
  /// `{"drive": {"velocity_max_x_mps": 0.5}}`.
  std::string setting;

  friend bool operator==(const Act&, const Act&) = default;
};
/// The names of the actions in files and messages, in the order of Act::Kind.
inline constexpr std::array<std::string_view, 10> k_acts{"move", "speed",  "hold",    "release", "command",
                                                         "add",  "remove", "disable", "enable",  "set"};

}  // namespace troupe::engine
