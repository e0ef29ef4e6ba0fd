#pragma once

#include "engine/fields.hpp"

namespace troupe::worldio {

/// The table of the parameters of a world's `window` (engine::WorldSpec::window). They are those of Stage's
/// `window`: camera poses and which layers are drawn.
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
