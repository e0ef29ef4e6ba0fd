#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Return the definitions of the controllers `fasr` and `fasr2`: foraging in a building. A robot fetches
/// flags (coloured tokens) from a source, one at a time, and brings them to a sink. When its power pack
/// (battery) runs low, it goes to a charger. Sources, sinks and chargers are bodies of the world. A decision
/// is one call of the controller.
///
/// The two controllers differ in their tasks, as in Stage's examples:
/// fasr   one task: from the body whose name is the parameter `source` to the body whose name is the
///        parameter `sink`
/// fasr2  up to eight tasks, which the parameters `task` to `task8` name. The task "red" leads from the body
///        red_source to the body red_sink. A robot starts with a random task, and chooses a new random task
///        after each delivery
///
/// paths     Robots follow cheapest paths on a 32 x 32 raster of the floor plan whose name is the parameter
///           `map` (models/controllers/floor_plan.hpp). Stage's fasr has direction tables instead, which are
///           made by hand for one cave.
/// avoids    A robot turns away from obstacles ahead that its scanner sees. The scanner is a ranger with more
///           than 8 beams. A robot that is stuck backs out (models/controllers/evasion.hpp).
/// fetches   A robot takes a flag after more than 20 consecutive decisions within 2 m of the source, and
///           gives it to the sink after more than 20 consecutive decisions within 1 m of the sink.
/// charges   If the pack holds less than 25 % of its capacity (fasr2: 20 %), the robot goes to the nearest
///           charger, to within 0.08 m. It stands there until the pack holds 95 %, and then drives backwards
///           for 5 s at most. If the robot has a fiducial finder (a sensor that detects marked objects), the
///           readings of the finder guide it for the last part of the way to the charger. A robot without a
///           pack, or in a world without chargers, never charges.
/// charger   A charger is a body that is in the world from the start and has a fiducial_return of 2 (the
///           number that fiducial finders read). If only a part of a body has it, this part is the charger.
/// waits     Only fasr2: a robot that waits changes its goal with a probability of 0.0005 per decision. At a
///           source, it chooses a random task; at a charger, a random charger. The choice may be the same
///           task or charger again.
/// zone      Only fasr2: if there is a body named fuel_zone, a robot that must charge goes to this body
///           first. From there it goes to the charger that is nearest then.
/// switches  Only fasr2: the fiducial finder is on only while the robot goes to a charger (not to the
///           fuel_zone), charges, and leaves the charger. The scanner is off while the robot drives the last
///           half metre to a charger, and while it charges.
/// needs     a drive, a scanner, a device `flags`, and the sources and sinks in the world
///@{
engine::ControllerKind fasr_controller();
engine::ControllerKind fasr2_controller();
///@}

}  // namespace troupe::models
