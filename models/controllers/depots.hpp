#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Creates flags for robots to take: at each decision, if its model holds fewer than `capacity` flags, it
/// adds a yellow flag of 0.25 m.
engine::ControllerKind source_controller();

/// Receives flags: counts the flags given to its model, and deletes one flag per decision to make room for
/// more.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
