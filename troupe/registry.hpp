#pragma once

#include "engine/kinds.hpp"

namespace troupe {

/// Every model, sensor, drive, controller and measure that Troupe ships: the explicit list.
engine::Registry make_registry();

}  // namespace troupe
