#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// State of a part that drives on its body.
struct WheelsState {
  double x = 0;              ///< m, world frame; x, y, z and heading are the pose at the start of the tick
  double y = 0;              ///< m
  double z = 0;              ///< m
  double heading = 0;        ///< rad
  double forward = 0;        ///< m/s, its own frame; velocity of this tick
  double left = 0;           ///< m/s
  double turn = 0;           ///< rad/s
  std::uint8_t stalled = 0;  ///< 1: its motion was blocked
  TROUPE_FIELDS(x, y, z, heading, forward, left, turn, stalled)
};

/// A drive for one part of a body, like a `position` inside another model of Stage: it drives in the frame of
/// the part that carries it, and moves with that part.
///
/// parameters  drive (diff, omni, car), and the parameters of that drive without localization and pushes
/// state       WheelsState; commands: engine::Command, as for the drive of a body
/// moves       as a joint, with the parts mounted on it, unless it would overlap a body outside its own tree
///             of carriers; a blocked motion leaves it where it is, stalled
/// estimate    its true pose in the world: controllers of its part see it, and goals are in the world frame
/// edges       it is due in each tick; it may leave the bounds of the world, but goes no farther than 100 m
///             from its position at rest
/// errors      a command that is not a finite number: engine::StepError
engine::DeviceKind wheels_kind();

}  // namespace troupe::models
