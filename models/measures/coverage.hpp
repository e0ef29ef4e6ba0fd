#pragma once

#include "engine/measure_kind.hpp"

namespace troupe::models {

/// `coverage`: fraction of the square cells of free ground that robots have visited since measuring began
/// (docs/measures.md). A cell is free if its centre is in no static obstacle. NaN if no cell is free.
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
