#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// The controller `source` creates flags (coloured tokens) for robots to take. At each call, it adds one
/// yellow flag (k_yellow_flag) to the device `flags` of its model. It adds no flag if the device is full or
/// holds `capacity` (a parameter) flags or more.
engine::ControllerKind source_controller();

/// The controller `sink` receives flags. It stores in its memory how many flags other bodies have given to
/// its model since tick 0. At each call, it deletes one flag from the device `flags` of its model, to
/// make room for more flags.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
