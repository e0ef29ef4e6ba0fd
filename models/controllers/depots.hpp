#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Makes flags: at each update pushes a yellow one of 0.25 m while its model holds fewer than `capacity`.
/// Robots take them.
engine::ControllerKind source_controller();

/// Where flags are brought to: counts those that were given to its model, and takes them off it, one an
/// update, so that there is always room.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
