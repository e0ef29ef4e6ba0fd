#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// Returns the definition of the measure `coverage` (docs/measures.md), a number that is computed during a
/// run: the fraction of the free cells of the ground that robots have visited since measuring began. Cells
/// are squares whose edge length is the parameter `cell` (m). A robot visits the cell that contains its
/// origin after a simulation step. A cell is free if its centre is in no static obstacle. NaN if no cell is
/// free.
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
