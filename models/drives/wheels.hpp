#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

namespace troupe::models {

/// Where a part that drives on its body is, and how it moves.
struct WheelsState {
  double x = 0;              ///< m, world frame, as is what follows: where it was when it last set out
  double y = 0;              ///< m
  double z = 0;              ///< m
  double heading = 0;        ///< rad
  double forward = 0;        ///< m/s, its own frame, of this tick
  double left = 0;           ///< m/s
  double turn = 0;           ///< rad/s
  std::uint8_t stalled = 0;  ///< 1: something was in the way
  TROUPE_FIELDS(x, y, z, heading, forward, left, turn, stalled)
};

/// A drive that a part of a body has for itself, as a `position` inside another model of Stage: it drives in
/// the frame of what it stands on, and goes where that goes.
///
/// parameters  drive (diff, omni, car), and those of the drive but for its localization
/// state       WheelsState; commands: engine::Command, as those of a body's own drive
/// moves       as a joint: with what stands on it, until it would overlap something that is no part of its
///             own tree; a motion that is refused leaves it where it is, stalled
/// estimate    its true pose in the world: what controllers of its part know, and what goals are given in
/// edges       it is due in each tick; the bounds of the world do not hold it, but it goes no farther than
///             100 m from where it is at rest
/// errors      a command that is no finite number: engine::StepError
engine::DeviceKind wheels_kind();

}  // namespace troupe::models
