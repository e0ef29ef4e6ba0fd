#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `source`, which creates flags (coloured tokens) for robots to
/// take. The model (body) that has the controller needs a device `flags`, which is a list of flags. At each
/// call, the controller adds one yellow flag (k_yellow_flag) to this list. It adds no flag if the list is
/// full or holds `capacity` (a parameter) flags or more.
engine::ControllerKind source_controller();

/// Returns the definition of the controller `sink`, which receives flags. The controller stores in its memory
/// (variables that can be recorded) how many flags other bodies have given to its model (the body that has
/// the controller) since the start of the run. At each call, it deletes one flag from the device `flags` of
/// its model, which is a list of flags, to make room for more flags.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
