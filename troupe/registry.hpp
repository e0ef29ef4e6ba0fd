#pragma once

#include "engine/kinds.hpp"

namespace troupe {

/// A registry of every model, sensor, drive, controller and measure that Troupe ships.
engine::Registry make_registry();

}  // namespace troupe
