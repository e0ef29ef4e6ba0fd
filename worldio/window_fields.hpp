#pragma once

#include "engine/fields.hpp"

namespace troupe::worldio {

/// The window through which a world asks to be seen (engine::WorldSpec::window), Stage's `window`: where its
/// cameras stand, and what is drawn.
const engine::FieldTable& window_fields();

}  // namespace troupe::worldio
