#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Foraging in a building: a robot fetches flags from a source, one at a time, brings them to a sink, and
/// charges its pack at chargers. Two controllers, as in Stage's examples:
///
/// fasr    one source and one sink, named by parameters
/// fasr2   up to eight pairs: the task "red" leads from the model red_source to the model red_sink. Each
///         robot draws a random task, and a new one after each delivery; with a small probability, a robot
///         that waits gives up and takes another task or charger
///
/// paths    from every cell of a 32 x 32 raster of the floor plan `map`, found by A* when the world is built
///          (models/controllers/floor_plan.hpp). Stage's fasr has direction tables made by hand for one cave
/// avoids   obstacles that a scanner of more than 8 beams sees ahead, as `wander` does; backs out if it is
///          stuck
/// fetches  after more than 20 consecutive updates within 2 m of the source; delivers likewise within 1 m of
///          the sink
/// zone     with a model `fuel_zone`, fasr2 goes there first, then to the charger nearest from there
/// senses   fasr2 switches its finder on only while it docks and leaves, and its scanner off for the last
///          half metre to a charger and while it charges
/// charges  below 25 % (fasr2: 20 %), goes to the nearest model whose fiducial_return is 2, until it touches
///          the charger and is charged; leaves at 95 %, backwards. With a fiducial finder it docks by the
///          readings of the finder. Never without a pack or without chargers
/// needs    a drive, a scanner, flags
///@{
engine::ControllerKind fasr_controller();
engine::ControllerKind fasr2_controller();
///@}

}  // namespace troupe::models
