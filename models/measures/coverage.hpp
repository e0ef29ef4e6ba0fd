#pragma once

#include "engine/measure_kind.hpp"

namespace troupe::models {

/// How much of the ground robots have been on: docs/measures.md.
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
