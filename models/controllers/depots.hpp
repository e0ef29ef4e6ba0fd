#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Creates flags: at each update adds a yellow flag of 0.25 m while its model holds fewer than `capacity`.
/// Robots take them.
engine::ControllerKind source_controller();

/// Receives flags: counts the flags given to its model, and deletes one per update, so that there is room for
/// more.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
