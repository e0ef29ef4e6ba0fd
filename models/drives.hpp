#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Velocity mode, as in Stage: the speed of the next tick is the command within its bounds; acceleration is
/// not limited.
/// diff  v = (x, 0), turn = turn
/// omni  v = (x, y), turn = turn
/// car   v = (x cos(steering), 0), turn = x sin(steering) / wheelbase; the command's turn is the steering
/// angle
engine::DriveKind diff_drive();
engine::DriveKind omni_drive();
engine::DriveKind car_drive();

}  // namespace troupe::models
