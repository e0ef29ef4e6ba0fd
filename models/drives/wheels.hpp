#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// State of a part that drives on its body. x, y, z and heading are its pose in the world frame at the start
/// of the tick; forward, left and turn are its velocity in this tick, in its own frame.
struct WheelsState {
  double x = 0;              ///< m, world frame
  double y = 0;              ///< m, world frame
  double z = 0;              ///< m, world frame
  double heading = 0;        ///< rad, world frame
  double forward = 0;        ///< m/s, frame of the part
  double left = 0;           ///< m/s, frame of the part
  double turn = 0;           ///< rad/s, counter-clockwise
  std::uint8_t stalled = 0;  ///< 1: the motion of the part was blocked
  TROUPE_FIELDS(x, y, z, heading, forward, left, turn, stalled)
};

/// A drive for one part of a body, like a `position` model inside another model of Stage. The part drives
/// about relative to the part that carries it, and also moves with that part.
///
/// parameters  drive (diff, omni, car), and the parameters of that drive without localization and pushes
/// state       WheelsState; commands: engine::Command, as for the drive of a body
/// moves       The part moves as a joint does, together with the parts mounted on it. A motion is blocked if
///             it would overlap a body or a wall, except its own body and bodies that carry it or that it
///             carries. A blocked part keeps its pose and is stalled.
/// estimate    The estimated pose of the part is its true pose in the world. Its controllers see this pose,
///             and its goals are in the world frame.
/// edges       It runs in each tick. It may leave the bounds of the world, but goes no farther than 100 m
///             from its position in the world file.
/// errors      A command that is not a finite number throws engine::StepError.
engine::DeviceKind wheels_kind();

}  // namespace troupe::models
