#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

namespace troupe::models {

/// The command of an actuator (a motor-driven joint). It holds until the controller replaces it. Without a
/// command, the joint stands still.
struct ActuatorCommand {
  /// The meaning of the member `goal`.
  enum Mode : std::uint8_t {
    velocity,  ///< `goal` is a velocity, with a sign
    position,  ///< `goal` is a position
  };
  std::uint8_t mode = velocity;  ///< meaning of `goal`, a Mode
  double goal = 0;               ///< velocity mode: m/s or rad/s; position mode: m or rad

  static constexpr void describe(engine::Description<ActuatorCommand>& d) {
    d.member<&ActuatorCommand::mode>("mode", "0: `goal` is a velocity; 1: `goal` is a position");
    d.member<&ActuatorCommand::goal>("goal", "velocity (m/s or rad/s) or position (m or rad): see `mode`");
  }
};

/// State of an actuator, a joint that moves the parts mounted on it. A tick is a time step.
struct ActuatorState {
  /// Position of the joint: m along its axis (linear joint), or rad about the vertical axis (rotational
  /// joint), counter-clockwise. At 0, the moved parts are where the world file places them.
  double position = 0;
  double velocity = 0;       ///< velocity in this tick, m/s or rad/s; 0 if stalled
  double asked = 0;          ///< position at the end of this tick if the motion is not blocked, m or rad
  std::uint8_t stalled = 0;  ///< 1: the motion of the joint in this tick was blocked

  static constexpr void describe(engine::Description<ActuatorState>& d) {
    d.member<&ActuatorState::position>(
        "position", "position of the joint, m (linear) or rad (rotational); 0 is the pose in the world file");
    d.member<&ActuatorState::velocity>("velocity", "velocity in this tick, m/s or rad/s; 0 if stalled");
    d.member<&ActuatorState::asked>(
        "asked", "position at the end of this tick unless the motion of the joint is blocked, m or rad");
    d.member<&ActuatorState::stalled>("stalled", "1: the motion of the joint in this tick was blocked");
  }
};

/// Returns the definition of the device `actuator`: a joint that moves the parts mounted on it, along an axis
/// (linear) or about a vertical axis (rotational). A tick is a time step.
///
/// parameters  type (linear or rotational), axis (x, y, z, frame of the actuator; only for linear),
///             min_position, max_position (m or rad), max_speed (m/s or rad/s), start_position (m or rad)
/// state       ActuatorState; commands: ActuatorCommand
/// moves       In velocity mode, the joint moves at the commanded velocity, which is clamped to +-max_speed,
///             and stops at min_position and max_position. In position mode, it moves at max_speed to the
///             commanded position, which is clamped to min_position and max_position, and stops exactly
///             there. A command may be infinite. If it is NaN, the step throws a StepError.
/// blocked     If the moved parts would overlap a body or static geometry, the joint does not move in this
///             tick, and is stalled.
/// draws       2 W from the power pack (battery) that supplies the actuator, even if the joint stands still
/// edges       An axis of length 0 means the x axis. If min_position or max_position is changed during the
///             run so that the joint is outside this range, the joint moves back to the nearer limit at
///             max_speed.
engine::DeviceKind actuator_kind();

}  // namespace troupe::models
