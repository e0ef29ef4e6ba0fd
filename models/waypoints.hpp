#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Goes from goal to goal, each in the frame of the robot's estimate; the next one once it believes to be
/// near the last. After the last it stays there, or begins again.
engine::ControllerKind waypoints_controller();

}  // namespace troupe::models
