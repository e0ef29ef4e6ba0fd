#pragma once

#include "engine/measure_kind.hpp"

namespace troupe::models {

/// How far robots of several types are from standing in the order of their types, from a centre outwards.
engine::MeasureKind rank_errors_measure();

}  // namespace troupe::models
