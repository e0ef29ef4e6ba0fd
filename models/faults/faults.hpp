#pragma once

#include "engine/fault_kind.hpp"

namespace troupe::models {

/// Sensors that stop working: they keep their last readings, and controllers cannot tell.
engine::FaultKind dead_sensors_fault();

/// A drive that is slower than commanded: all its velocities are multiplied by `factor`. Odometry counts the
/// motion that results.
engine::FaultKind slow_wheels_fault();

/// A robot that stops completely after an exponentially distributed time of mean 1 / `rate`, for good or for
/// a while.
engine::FaultKind drop_out_fault();

}  // namespace troupe::models
