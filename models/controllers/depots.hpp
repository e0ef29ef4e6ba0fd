#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `source`: a body that provides flags (coloured tokens), which
/// robots take. The body must have a device of the kind `flags`, which is a list of flags. In each call, the
/// controller adds one yellow flag (k_yellow_flag) to this list, as long as the list holds fewer than
/// `capacity` (a parameter) flags and is not full.
engine::ControllerKind source_controller();

/// Returns the definition of the controller `sink`: a body to which robots give flags (coloured tokens). The
/// body must have a device of the kind `flags`, which is a list of flags. The controller stores in its memory
/// (variables that a recording can contain) how many flags other bodies have given to the body since the
/// start of the run. In each call, it also deletes one flag from the list, if there is any, to make room for
/// more flags.
engine::ControllerKind sink_controller();

}  // namespace troupe::models
