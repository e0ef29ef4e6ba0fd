#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `wander`: a robot drives straight on and turns away from
/// obstacles that its ranger sees ahead, like the example `wander` of Stage. The controller reads the first
/// ranger that sees ahead and has a transducer (fan of beams) with more than 8 beams. If there is no such
/// ranger, it reads the first ranger that sees ahead and has more than 8 beams in total.
engine::ControllerKind wander_controller();

}  // namespace troupe::models
