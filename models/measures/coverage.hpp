#pragma once

#include "engine/measure_kind.hpp"

namespace troupe::models {

/// `coverage`: fraction of the free ground, counted in square cells, that robots have visited since measuring
/// began (docs/measures.md); NaN if no cell is free.
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
