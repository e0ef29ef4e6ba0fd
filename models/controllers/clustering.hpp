#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `clustering`: robots push pucks together without sensing them.
///
/// Names in backquotes are parameters.
///
/// pushes  A robot drives straight on and pushes the pucks in its way. Its drive can push only a limited
///         number of pucks. If there are more in its way, the robot stands still. It notices this because its
///         estimated pose does not change. Then it drives backwards for the time `back` (s), away from the
///         pucks, and turns to a random side by a random angle of up to 180 degrees.
/// avoids  If the ranger of the robot sees a wall or another robot ahead, nearer than `min_front` (m), the
///         robot turns away from the nearer side by a random angle of up to 180 degrees.
/// needs   a drive, a ranger with more than 8 beams that sees ahead and is mounted above the pucks
/// source  Beckers, Holland, Deneubourg: From local actions to global tasks: stigmergy and collective
///         robotics, Artificial Life IV, 1994. In the paper, a switch behind the gripper senses a load of
///         three or more pucks. Here, the world file limits the load: it sets the parameter `pushes` of the
///         drive (greatest number of pucks that the robot pushes at once) to 2
engine::ControllerKind clustering_controller();

}  // namespace troupe::models
