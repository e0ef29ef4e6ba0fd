#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// `coverage`: fraction of the free cells of the ground that robots have visited since measuring began
/// (docs/measures.md). Cells are squares whose edge length is the parameter `cell` (m). A cell is free if its
/// centre is in no static obstacle. NaN if no cell is free.
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
