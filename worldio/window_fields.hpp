#pragma once

#include "engine/fields/fields.hpp"

namespace troupe::worldio {

/// Returns the table of the parameters of a world's `window` (engine::WorldSpec::window): their names, types,
/// limits and defaults. They are the settings of the `window` of Stage, an older robot simulator. Troupe uses
/// some of them to draw pictures with the option `--camera window`. The others have no effect in Troupe
/// (docs/world-format.md).
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
