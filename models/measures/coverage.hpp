#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// Returns the definition of the measure `coverage` (docs/measures.md): the fraction of the free ground that
/// robots have visited. A measure is a number that is computed from the state of the simulation.
///
/// The ground is divided into square cells; the parameter `cell` (m) is their edge length. A cell is free if
/// its centre is on the ground and in no static obstacle. A free cell is visited if, since measuring began,
/// it has contained the origin of a robot at the end of a tick (time step). The value is the number of
/// visited free cells divided by the number of free cells. NaN if no cell is free.
///
/// The ground is the bounds of the world. If the world has no bounds, the ground is the box around the static
/// scene and the start positions of the robots.
engine::MeasureKind coverage_measure();

}  // namespace troupe::models
