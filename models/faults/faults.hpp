#pragma once

#include "engine/fault_kind.hpp"

namespace troupe::models {

/// Sensors that do not look any more: they keep the readings that they had, of which a controller is not
/// told.
engine::FaultKind dead_sensors_fault();

/// A drive that gives less than it is asked for: all its speeds are `factor` of what they would be.
/// Odometry counts what the wheels did.
engine::FaultKind slow_wheels_fault();

/// A robot that stops with all it has, at a time that is exponentially distributed with mean 1 / `rate`, for
/// good or for a while.
engine::FaultKind drop_out_fault();

}  // namespace troupe::models
