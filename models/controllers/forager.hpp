#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Foraging in a building: a robot fetches flags from a source, one at a time, brings them to a sink, and
/// charges its pack where there are chargers. Two controllers, as in Stage's examples:
///
/// fasr    one source and one sink, named by parameters
/// fasr2   up to eight pairs: task "red" goes from model red_source to model red_sink. Which one is drawn
///         after each delivery; now and then a robot that waits gives up and goes elsewhere
///
/// ways     from every cell of a 32 x 32 raster of the floor plan `map`, found by A* when the world is built
///          (models/controllers/floor_plan.hpp). Stage's fasr has direction tables made by hand for one cave
/// avoids   what a scanner of more than 8 beams sees ahead, as `wander` does; backs out where it is stuck
/// fetches  after more than 20 updates in a row within 2 m of the source; delivers likewise within 1 m of the
///          sink
/// zone     fasr2 with a model `fuel_zone`: goes there first, then to the charger that is nearest then
/// senses   fasr2 switches its finder on where it docks, and its scanner off for the last half metre to a
///          charger and while it charges
/// charges  below 25 % (fasr2: 20 %) goes to the nearest model whose fiducial_return is 2, until it touches
///          and is charged; leaves at 95 %, backwards. With a fiducial finder it steers by what that sees;
///          without a pack, or where there are no chargers, it never does
/// needs    a drive, a scanner, flags
///@{
engine::ControllerKind fasr_controller();
engine::ControllerKind fasr2_controller();
///@}

}  // namespace troupe::models
