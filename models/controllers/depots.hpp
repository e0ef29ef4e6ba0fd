#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// The controller `source` creates flags (coloured tokens) for robots to take. At each decision, it adds a
/// yellow flag of 0.25 m to the device `flags` of its model if the model holds fewer flags than the parameter
/// `capacity` and there is room for one.
engine::ControllerKind source_controller();

/// The controller `sink` receives flags. It stores in its memory how many flags its model has received since
/// tick 0, and deletes one flag per decision to make room for more.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
