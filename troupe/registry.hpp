#pragma once

#include "engine/kinds.hpp"

namespace troupe {

/// Returns a registry with all kinds of models, sensors, drives, controllers and measures that Troupe ships.
engine::Registry make_registry();

}  // namespace troupe
