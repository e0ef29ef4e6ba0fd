#pragma once

#include "engine/fields/fields.hpp"

namespace troupe::worldio {

/// The table of the parameters of a world's `window` (engine::WorldSpec::window): their names, types, limits
/// and defaults. The parameters are those of Stage's `window`: its size, its cameras, which layers it draws,
/// how often it is updated, and its screenshots. Several of these parameters have no effect in Troupe
/// (docs/world-format.md).
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
