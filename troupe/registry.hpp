#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe {

/// Returns a registry with everything that Troupe ships: all kinds of models, sensors, other devices, drives,
/// controllers, measures and faults, and the presets (named controllers whose parameters differ from the
/// defaults of their kind).
engine::Registry make_registry();

}  // namespace troupe
