#pragma once

#include "engine/fields.hpp"

namespace troupe::worldio {

/// The table of the parameters of a world's `window` (engine::WorldSpec::window): their names, types, limits
/// and defaults. They are the parameters of Stage's `window`: its size, the poses of its cameras, and which
/// layers it draws.
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
