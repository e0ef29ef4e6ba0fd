#pragma once

#include "engine/kinds.hpp"

#include <string>

namespace troupe::worldio {

/// The generated part of docs/world-format.md, as Markdown: poses, `watch`, `window`, and the parameters of
/// all drives, devices, controllers, faults and presets, with keys, units, limits and defaults.
std::string world_format_reference(const engine::Registry& registry);

/// The generated part of docs/measures.md, as Markdown: all measures with column, definition and parameters.
std::string measures_reference(const engine::Registry& registry);

}  // namespace troupe::worldio
