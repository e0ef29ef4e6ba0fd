#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `wander`: a robot drives straight on and turns away from
/// obstacles that its ranger sees ahead, like the example `wander` of Stage. The controller reads the first
/// ranger that sees ahead and has more than 8 beams in one transducer (fan of beams). If there is none, it
/// reads the first ranger that sees ahead and has more than 8 beams in all its transducers together.
engine::ControllerKind wander_controller();

}  // namespace troupe::models
