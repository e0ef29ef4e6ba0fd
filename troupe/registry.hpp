#pragma once

#include "engine/kinds/registry.hpp"

namespace troupe {

/// Returns a registry with everything that Troupe ships. A registry is the list of the kinds that a world can
/// use. A kind is an implementation of a model, sensor, other device, drive, controller, measure or fault,
/// such as the sensor `ranger`. The registry also contains the presets: named controllers whose parameters
/// differ from the defaults of their kind.
engine::Registry make_registry();

}  // namespace troupe
