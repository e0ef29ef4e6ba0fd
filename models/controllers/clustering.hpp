#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// `clustering`: pushes pucks together without sensing them.
///
/// A robot drives straight on and pushes what is in its way. If it stalls because the load is too large, it
/// backs off, which leaves the load behind, and turns by a random angle. Its scanner looks over the pucks,
/// and makes it turn away from walls and other robots.
///
/// source  Beckers, Holland, Deneubourg: From local actions to global tasks: stigmergy and collective
///         robotics, Artificial Life IV, 1994. There, a switch behind the gripper senses three or more pucks;
///         here, the drive's `pushes` is 2, and the robot notices that it does not move
engine::ControllerKind clustering_controller();

}  // namespace troupe::models
