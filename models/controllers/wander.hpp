#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Drives about and turns away from obstacles ahead, like Stage's example of this name. It reads the first
/// ranger that sees ahead and has more than 8 beams in one transducer, else the first with as many in all.
engine::ControllerKind wander_controller();

}  // namespace troupe::models
