#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `clustering`: robots push pucks together without sensing them.
///
/// A robot drives straight on and pushes the pucks in its way. If it stalls because there are too many pucks
/// to push, it first drives backwards for the time `back` (s, a parameter), so that the pucks stay where they
/// are. Then it turns by a random angle of up to 180 degrees. It also turns by such an angle away from walls
/// and other robots that its ranger sees ahead, nearer than the parameter `min_front` (m).
///
/// needs   a drive, a ranger with more than 8 beams that sees ahead and is mounted above the pucks
/// source  Beckers, Holland, Deneubourg: From local actions to global tasks: stigmergy and collective
///         robotics, Artificial Life IV, 1994. In the paper, a switch behind the gripper senses a load of
///         three or more pucks. Here, the world file sets the parameter `pushes` of the drive, the greatest
///         number of pucks that a robot pushes at once, to 2, so that a larger load blocks the robot. The
///         robot notices this because its estimated pose does not change
engine::ControllerKind clustering_controller();

}  // namespace troupe::models
