#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"
#include "models/drives/drives.hpp"

#include <string_view>

namespace troupe::models {

/// State of the device `wheels`, a drive that moves one part of a body relative to the body. A tick is a
/// time step. All members are 0 before the drive runs for the first time.
///
/// x, y, z and heading are the pose of the part at the start of the tick in which the drive last ran.
/// forward, left and turn are the velocity that the drive commands in that tick, even if the motion is
/// blocked. They are 0 while the drive is stopped: by a fault, by an empty power pack (battery), or because
/// the body is disabled.
struct WheelsState {
  double x = 0;              ///< x of the part, m, world frame
  double y = 0;              ///< y of the part, m, world frame
  double z = 0;              ///< height of the part, m, world frame
  double heading = 0;        ///< heading of the part, rad, world frame
  double forward = 0;        ///< forward speed, m/s, frame of the part
  double left = 0;           ///< speed to the left, m/s, frame of the part
  double turn = 0;           ///< turn rate, rad/s, counter-clockwise
  std::uint8_t stalled = 0;  ///< 1: the motion of the part in this tick was blocked

  static constexpr void describe(engine::Description<WheelsState>& d) {
    using enum engine::Unit;
    d.member<&WheelsState::x>("x", meters, "x of the part before the last run of its drive, world frame");
    d.member<&WheelsState::y>("y", meters, "y of the part before the last run of its drive, world frame");
    d.member<&WheelsState::z>("z", meters,
                              "height of the part before the last run of its drive, world frame");
    d.member<&WheelsState::heading>("heading", radians,
                                    "heading of the part before the last run of its drive, world frame");
    d.member<&WheelsState::forward>("forward", meters_per_second, "velocity of the part, forward");
    d.member<&WheelsState::left>("left", meters_per_second, "velocity of the part, to the left");
    d.member<&WheelsState::turn>("turn", radians_per_second,
                                 "angular velocity of the part, counter-clockwise");
    d.member<&WheelsState::stalled>("stalled", "1: the motion of the part in this tick was blocked");
  }
};

/// Returns the definition of the device `wheels`: a drive for one part of a body, like a `position` model
/// inside another model of Stage. The part on which the device is mounted moves relative to the part that
/// carries it, and also moves along with it. A tick is a time step.
///
/// parameters  drive (diff, omni or car), and the parameters of that kind of drive, except `pushes`, the
///             start velocities (start_x, start_y, start_turn) and the parameters of localization
/// state       WheelsState; commands: engine::Command, as for the drive of a body
/// moves       The part moves together with the parts mounted on it. Its motion is blocked if one of these
///             parts would overlap a wall or another body. The part then keeps its pose, and is stalled.
///             Bodies that move together with the part's body, because one carries the other or a third body
///             carries both, do not block the motion.
/// estimate    The estimated pose of the part is its true pose, in the world frame. Controllers of the part
///             read this pose, and give goals in the world frame.
/// when        The drive runs, and the part moves, once per period of the device, by default in each tick.
/// edges       The part may leave the bounds of the world. The part can move at most 100 m away from its
///             place on the body in the world file: motions beyond are blocked.
/// errors      If a command is not a finite number, the step throws engine::StepError.
engine::DeviceKind wheels_kind();

/// The drive of a device `wheels`: its kind ("diff", "omni" or "car") and its limits.
struct WheelsDrive {
  std::string_view kind;  ///< name of the kind of drive
  MotionParams motion;    ///< limits of its velocities and accelerations
};
/// Returns the drive of a device `wheels` with the parameters `params`.
WheelsDrive drive_of_wheels(const engine::Record& params);

}  // namespace troupe::models
