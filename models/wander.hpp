#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Drives about and turns from what a scanner sees ahead: the behaviour of Stage's example of this name.
/// Reads the first ranger whose first transducer has more than 8 samples.
engine::ControllerKind wander_controller();

}  // namespace troupe::models
