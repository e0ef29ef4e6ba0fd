#pragma once

#include "engine/kinds.hpp"

#include <string>

namespace troupe::worldio {

/// The part of docs/world-format.md that follows from the field tables, as Markdown: the parameters of every
/// drive, sensor, controller and preset with their keys, units, limits and defaults.
std::string world_format_reference(const engine::Registry& registry);

/// The part of docs/measures.md that follows from the kinds: every measure with its column, its definition
/// and its parameters.
std::string measures_reference(const engine::Registry& registry);

}  // namespace troupe::worldio
