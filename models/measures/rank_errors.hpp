#pragma once

#include "engine/measure_kind.hpp"

namespace troupe::models {

/// `rank_errors`: fraction of the pairs of robots of different types whose distances from a centre are in the
/// wrong order (docs/measures.md).
engine::MeasureKind rank_errors_measure();

}  // namespace troupe::models
