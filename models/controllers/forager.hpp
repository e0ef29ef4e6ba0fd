#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Foraging in a building: a robot fetches flags (coloured tokens) from a source, one at a time, brings them
/// to a sink, and charges its power pack at chargers. There are two controllers, as in Stage's examples:
///
/// fasr    one source and one sink, named by parameters
/// fasr2   up to eight tasks, each with a source and a sink: the task "red" leads from the model red_source
///         to the model red_sink. Each robot draws a random task, and a new one after each delivery. With a
///         small probability, a robot that waits at a source or a charger draws another task or charger
///
/// paths    Robots follow cheapest paths on a 32 x 32 raster of the floor plan `map`, found by A* when the
///          world is built (models/controllers/floor_plan.hpp). Stage's fasr has direction tables instead,
///          made by hand for one cave.
/// avoids   A robot turns away from obstacles that its scanner, a ranger of more than 8 beams, sees ahead, as
///          `wander` does. If it is stuck, it backs out.
/// fetches  A robot takes a flag after more than 20 consecutive decisions within 2 m of the source, and
///          delivers it after as many within 1 m of the sink.
/// charges  When its pack is below 25 % (fasr2: 20 %), a robot goes to the nearest model whose
///          fiducial_return is 2, until it touches this charger and is charged. At 95 % it drives away
///          backwards. With a fiducial finder it docks by the readings of the finder. A robot without a pack,
///          or in a world without chargers, never charges.
/// zone     If there is a model `fuel_zone`, fasr2 goes there first, and then to the charger that is nearest
///          from there.
/// senses   fasr2 switches its fiducial finder on only while it docks and leaves. It switches its scanner off
///          for the last half metre to a charger and while it charges.
/// needs    a drive, a scanner, a device `flags`
///@{
engine::ControllerKind fasr_controller();
engine::ControllerKind fasr2_controller();
///@}

}  // namespace troupe::models
