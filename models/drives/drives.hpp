#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// What a command becomes, within the bounds of its drive; docs/driving.md has the whole of it.
///
/// speed   as in Stage the speed of the next tick; acceleration is not limited
///         diff  v = (x, 0), turn = turn
///         omni  v = (x, y), turn = turn
///         car   v = (x cos(steering), 0), turn = x sin(steering) / wheelbase, where turn is the steering
///         angle
/// acceleration   within bounds of its own, times the time since the drive was due, is added to the last
///         tick's velocity; a car's to the speed of its front wheels
/// goal    proportional to what is missing (1/s), at most 0.4 m/s and 1 rad/s; arrived within 0.02 m
///         diff  turns to the goal, drives while it is within pi/16 ahead, then turns to the goal's heading
///         omni  straight to the goal, turning on the way
///         car   in a curve, turning twice as fast; swings about its rear axle towards what lies behind it
///@{
engine::DriveKind diff_drive();
engine::DriveKind omni_drive();
engine::DriveKind car_drive();
///@}

}  // namespace troupe::models
