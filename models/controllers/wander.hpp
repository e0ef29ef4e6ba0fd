#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Drives about and turns from what a scanner sees ahead: the behaviour of Stage's example of this name.
/// Reads a scanner: the first ranger with a fan of more than 8 beams that sees ahead, else the first one
/// with as many in several transducers.
engine::ControllerKind wander_controller();

}  // namespace troupe::models
