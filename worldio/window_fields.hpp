#pragma once

#include "engine/fields/fields.hpp"

namespace troupe::worldio {

/// Returns the table of the parameters of a world's `window` (engine::WorldSpec::window): their names, types,
/// limits and defaults. A world file sets them for the view that the option `--camera window` draws. They are
/// the parameters of the `window` of Stage, an older robot simulator: its size, its cameras, which layers it
/// draws, how often it is updated, and its screenshots. Several of these parameters have no effect in Troupe
/// (docs/world-format.md).
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
