#pragma once

#include "engine/fault_kind.hpp"

namespace troupe::models {

/// Sensors that stop working: they repeat their last readings. Controllers cannot distinguish these from new
/// readings.
engine::FaultKind dead_sensors_fault();

/// A drive that is slower than commanded: all its velocities are multiplied by `factor`. Odometry counts the
/// slower motion, so the fault adds no error to it.
engine::FaultKind slow_wheels_fault();

/// A robot that stops completely after an exponentially distributed time of mean 1 / `rate`, for good or for
/// a while.
engine::FaultKind drop_out_fault();

}  // namespace troupe::models
