#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// `clustering`: pushes pucks together without knowing of them.
///
/// goes straight on and pushes what is in its way; who stalls, because that is too much, backs off, which
/// leaves what it pushed, and turns by a random angle. Its scanner, which looks over pucks, has it turn away
/// from walls and other robots
///
/// source  Beckers, Holland, Deneubourg: From local actions to global tasks: stigmergy and collective
/// robotics,
///         Artificial Life IV, 1994. There a switch behind the gripper feels three pucks or more; here the
///         drive's `pushes` is 2, and the robot notices that it stands
engine::ControllerKind clustering_controller();

}  // namespace troupe::models
