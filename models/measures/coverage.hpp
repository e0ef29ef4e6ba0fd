#pragma once

#include "engine/measure_kind.hpp"

namespace troupe::models {

/// `coverage`: fraction of the free ground that robots have visited (docs/measures.md).
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
