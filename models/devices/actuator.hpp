#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// What controllers ask of an actuator; it stays so until they ask otherwise.
struct ActuatorCommand {
  /// What `goal` is.
  enum Mode : std::uint8_t {
    velocity,  ///< `goal` is a speed
    position,  ///< `goal` is a place
  };
  std::uint8_t mode = velocity;  ///< a Mode
  double goal = 0;               ///< m/s or rad/s; in position mode m or rad
  TROUPE_FIELDS(mode, goal)
};

/// Where an actuator is.
struct ActuatorState {
  double position = 0;       ///< m along the axis or rad about it, from where the world file puts the model
  double velocity = 0;       ///< m/s or rad/s, of this tick
  double asked = 0;          ///< where it was to be after this tick
  std::uint8_t stalled = 0;  ///< 1: something was in the way
  TROUPE_FIELDS(position, velocity, asked, stalled)
};

/// A joint that moves what stands on it, along an axis or about a vertical one.
///
/// parameters  type (linear or rotational), axis (x, y, z; linear), min_position, max_position (m or rad),
///             max_speed (m/s or rad/s), start_position
/// state       ActuatorState; commands: ActuatorCommand
/// moves       velocity mode: at the speed asked for, at most max_speed, and to a stop at the limits;
///             position mode: towards the goal, kept within the limits, at max_speed, arriving in time
/// draws       2 W from its supply while it runs
/// edges       an axis of no length is the x axis; a body that it would overlap stops it where it is for
///             this tick: it is stalled
engine::DeviceKind actuator_kind();

}  // namespace troupe::models
