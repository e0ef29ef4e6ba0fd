#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// The command of an actuator. It holds until the controller replaces it.
struct ActuatorCommand {
  /// Meaning of `goal`.
  enum Mode : std::uint8_t {
    velocity,  ///< `goal` is a speed
    position,  ///< `goal` is a position
  };
  std::uint8_t mode = velocity;  ///< a Mode
  double goal = 0;               ///< m/s or rad/s; in position mode m or rad
  TROUPE_FIELDS(mode, goal)
};

/// State of an actuator.
struct ActuatorState {
  double position = 0;       ///< m along the axis or rad about it, from the pose in the world file
  double velocity = 0;       ///< m/s or rad/s, of this tick
  double asked = 0;          ///< position requested for the end of this tick, m or rad
  std::uint8_t stalled = 0;  ///< 1: its motion was blocked
  TROUPE_FIELDS(position, velocity, asked, stalled)
};

/// A joint that moves the parts mounted on it, along an axis or about a vertical axis.
///
/// parameters  type (linear or rotational), axis (x, y, z; linear), min_position, max_position (m or rad),
///             max_speed (m/s or rad/s), start_position
/// state       ActuatorState; commands: ActuatorCommand
/// moves       velocity mode: at the commanded speed, clamped to max_speed, and stops at the limits;
///             position mode: towards the goal, clamped to the limits, at max_speed; the last step is shorter
/// draws       2 W from its supply while it runs
/// edges       an axis of length 0 is the x axis; if it would overlap a body or static geometry, it does not
///             move in this tick, and is stalled
engine::DeviceKind actuator_kind();

}  // namespace troupe::models
