#pragma once

#include "engine/fields/state_table.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace troupe::engine {

/// The meaning of the numbers of a command.
enum class ControlMode : std::uint8_t {
  velocity,  ///< speeds, m/s and rad/s; for drives of kind `car`, `turn` is the steering angle, rad
  /// accelerations, m/s^2 and rad/s^2; for drives of kind `car`, `turn` is the steering angle, rad
  acceleration,
  position,  ///< a goal pose, m and rad, in the frame in which the robot estimates its pose (Localization)
};
inline constexpr std::size_t k_control_modes = 3;  ///< number of values of ControlMode

/// The command of a controller to its drive. Speeds and accelerations are in the body frame. Goals are in the
/// frame in which the robot estimates its pose (Localization). An assignment `command = {x, y, turn}` sets
/// all members: it commands a speed and switches all devices on.
struct Command {
  double x = 0;                              ///< forward, m/s or m/s^2; for a goal its x, m
  double y = 0;                              ///< left, m/s or m/s^2; for a goal its y, m
  double turn = 0;                           ///< turn, rad/s or rad/s^2; for a goal its heading, rad
  ControlMode mode = ControlMode::velocity;  ///< meaning of x, y and turn
  /// Devices that controllers have switched off: one bit per device (BodyType::Device::switch_bit).
  std::uint32_t off = 0;
};

/// The fields of a state table with commands: one StateField for each member of Command, in their order.
std::vector<StateField> command_fields();

/// The velocity that a drive gives its body.
struct Velocity {
  double x = 0;     ///< forward, body frame, m/s
  double y = 0;     ///< left, body frame, m/s
  double turn = 0;  ///< counter-clockwise, rad/s
};

}  // namespace troupe::engine
