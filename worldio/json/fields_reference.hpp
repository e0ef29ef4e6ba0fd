#pragma once

#include "engine/kinds.hpp"

#include <string>

namespace troupe::worldio {

/// Returns the generated part of docs/world-format.md as Markdown. It has a table for poses, for the objects
/// `watch` and `window` of a world, and for the parameters of each drive, sensor, other device, controller,
/// fault and controller preset. A table lists keys with their units, values with their limits, defaults and
/// meanings.
std::string world_format_reference(const engine::Registry& registry);

/// Returns the generated part of docs/measures.md as Markdown. It lists all measures, each with the name of
/// its column, its definition and its parameters.
std::string measures_reference(const engine::Registry& registry);

}  // namespace troupe::worldio
