#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// `rank_errors`: fraction of the pairs of robots of different types that are in the wrong order. A pair is
/// in the wrong order if its robot whose type comes later in the world file is nearer to the point `center`
/// (a parameter) than the other robot of the pair (docs/measures.md). NaN if all robots in the world are of
/// one type.
engine::MeasureKind rank_errors_measure();

}  // namespace troupe::models
