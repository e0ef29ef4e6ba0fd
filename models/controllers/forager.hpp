#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Return the definitions of the controllers `fasr` and `fasr2`: foraging in a building. A robot fetches
/// flags (coloured tokens) from a source, one at a time, brings them to a sink, and charges its power pack
/// (battery) at chargers. The two controllers differ in their tasks, as in Stage's examples:
///
/// fasr    one source and one sink, which are models named by the parameters `source` and `sink`
/// fasr2   up to eight tasks, each with a source and a sink: the task "red" leads from the model red_source
///         to the model red_sink. Each robot starts with a random task, and chooses a new random task after
///         each delivery. A robot that waits may also choose again, with a probability of 0.0005 per decision
///         (call of the controller): at a source it chooses a random task, at a charger a random charger. The
///         choice may be the present task or charger
///
/// paths    Robots follow cheapest paths on a 32 x 32 raster of a floor plan, the model that the parameter
///          `map` names. The paths are found by A* when the world is built
///          (models/controllers/floor_plan.hpp). Stage's fasr has direction tables instead, made by hand for
///          one cave.
/// avoids   A robot turns away from obstacles that its scanner, a ranger of more than 8 beams, sees ahead, as
///          the controller `wander` does: it turns on the spot or in a curve for a random number of
///          decisions. If it is stuck, it backs out.
/// fetches  A robot takes a flag after more than 20 consecutive decisions within 2 m of the source, and
///          delivers it after more than 20 consecutive decisions within 1 m of the sink.
/// charges  If its power pack holds less than 25 % of its capacity (fasr2: 20 %), a robot goes to the nearest
///          charger. A charger is a model that is in the world from the start and has the fiducial_return 2
///          (the number that fiducial finders read). If only a part of a model has this fiducial_return, the
///          part is the charger. The robot drives to within 0.08 m of the charger and stands there until its
///          pack holds 95 %. Then it drives away backwards, for 5 s at most. A robot with a fiducial finder
///          uses the readings of the finder for the last part of the way to the charger. A robot without a
///          power pack, or in a world without chargers, never charges.
/// zone     If there is a model `fuel_zone`, a robot with fasr2 that must charge goes there first. Then it
///          goes to the charger that is nearest from there.
/// senses   fasr2 switches the fiducial finder of its robot on only while the robot goes to a charger (not to
///          the fuel zone), charges and leaves the charger. It switches the scanner off for the last half
///          metre to a charger and while the robot charges.
/// needs    a drive, a scanner, a device `flags`, and the models of its sources and sinks in the world
///@{
engine::ControllerKind fasr_controller();
engine::ControllerKind fasr2_controller();
///@}

}  // namespace troupe::models
