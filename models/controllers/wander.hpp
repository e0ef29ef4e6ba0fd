#pragma once

#include "engine/kinds/kinds.hpp"

#include <any>
#include <string>

namespace troupe::models {

/// Returns the definition of the controller `wander`: a robot drives straight on and turns away from
/// obstacles that its ranger sees ahead, like the example `wander` of Stage. The controller reads the first
/// ranger that sees ahead and has a transducer (fan of beams) with more than 8 beams. If there is no such
/// ranger, it reads the first ranger that sees ahead and has more than 8 beams in total.
engine::ControllerKind wander_controller();

/// Returns why a robot with this controller can never drive straight on, as a text that continues the words
/// `controller "NAME"`. The result is empty if the robot can, or if the controller is not `wander`. prepared:
/// the data of a controller (ControllerKind::Prepared::data).
std::string why_wander_only_turns(const std::any& prepared);

}  // namespace troupe::models
