#pragma once

#include "engine/fields.hpp"

namespace troupe::worldio {

/// The parameters of a world's `window` (engine::WorldSpec::window), as of Stage's: camera poses and which
/// layers are drawn.
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
