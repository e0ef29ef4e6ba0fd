#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// State of a part of a body that has a drive of its own and moves relative to the body. x, y, z and heading
/// are the pose of the part at the start of the tick (simulation step). forward, left and turn are the
/// velocity that its drive produces in the tick, even if the motion is blocked. They are 0 while the drive is
/// stopped. A fault or an empty power pack (battery) can stop the drive, and it is also stopped while the
/// body is disabled. All members are 0 before the drive first runs.
struct WheelsState {
  double x = 0;              ///< x of the part, m, world frame
  double y = 0;              ///< y of the part, m, world frame
  double z = 0;              ///< height of the part, m, world frame
  double heading = 0;        ///< heading of the part, rad, world frame
  double forward = 0;        ///< speed forward, m/s, frame of the part
  double left = 0;           ///< speed to the left, m/s, frame of the part
  double turn = 0;           ///< turn rate, rad/s, counter-clockwise
  std::uint8_t stalled = 0;  ///< 1: the motion of the part in this tick was blocked

  static constexpr void describe(engine::Description<WheelsState>& d) {
    using enum engine::Unit;
    d.member<&WheelsState::x>("x", meters, "x of the part, world frame");
    d.member<&WheelsState::y>("y", meters, "y of the part, world frame");
    d.member<&WheelsState::z>("z", meters, "height of the part, world frame");
    d.member<&WheelsState::heading>("heading", radians, "heading of the part, world frame");
    d.member<&WheelsState::forward>("forward", meters_per_second, "velocity of the part, forward");
    d.member<&WheelsState::left>("left", meters_per_second, "velocity of the part, to the left");
    d.member<&WheelsState::turn>("turn", radians_per_second,
                                 "angular velocity of the part, counter-clockwise");
    d.member<&WheelsState::stalled>("stalled", "1: the motion of the part in this tick was blocked");
  }
};

/// Returns the definition of the device `wheels`: a drive for one part of a body, like a `position` model
/// inside another model of Stage. The driven part moves relative to the part on which it is mounted, and is
/// carried along when that part moves.
///
/// parameters  drive (diff, omni or car), and the parameters of that kind of drive, except `pushes`, the
///             start velocities (start_x, start_y, start_turn) and the parameters of localization
/// state       WheelsState; commands: engine::Command, as for the drive of a body
/// moves       The part and the parts mounted on it move together. A motion is blocked if one of these parts
///             would overlap a wall or another body. Bodies that move with the part's body (one carries the
///             other, or a third body carries both) do not block the motion. A blocked part keeps its pose
///             and is stalled.
/// estimate    The estimated pose of the part is its true pose in the world. The controllers of the part read
///             this pose, and give goals in the world frame.
/// edges       The drive runs, and the part moves, once per period of the device, by default in each tick.
///             The part may leave the bounds of the world. A motion that would take it farther than 100 m
///             from its place on the body in the world file is blocked.
/// errors      If a command is not a finite number, the step throws engine::StepError.
engine::DeviceKind wheels_kind();

}  // namespace troupe::models
