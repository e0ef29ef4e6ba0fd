#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// The controller `source` creates flags (coloured tokens) for robots to take. At each decision, it adds a
/// yellow flag of 0.25 m if its model holds fewer flags than the parameter `capacity`.
engine::ControllerKind source_controller();

/// The controller `sink` receives flags. It counts the flags that robots give to its model, and deletes one
/// flag per decision to make room for more.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
