#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `collector`: a robot searches for marked pucks, grips a puck,
/// carries it to a sink and releases it there. If its power pack (battery) runs low during the search, it
/// charges the pack first.
///
/// seeks    The robot drives straight on and turns away from obstacles ahead until its fiducial finder sees a
///          puck that is 0.8 m or more away from every sink. A puck is a model (an object of the world file)
///          whose fiducial_return, the number that fiducial finders read from a model, is the parameter
///          `puck`. The robot drives up to the puck, slowly for the last half metre, and closes its gripper
///          when the puck breaks the inner light beam of the gripper.
/// carries  It carries the puck to within 0.5 m of the nearest sink and opens the gripper there. Sinks are
///          the models that are in the world from the start and whose name is the parameter `sink`, or this
///          name followed by digits. A world without sinks is an error. The robot looks for sinks and
///          chargers where the world file places them, even if they have moved since.
/// charges  If the power pack holds less than 25 % of its capacity during the search, the robot goes to the
///          nearest charger and stands there until the pack holds 95 %. A charger is a model that is in the
///          world from the start and has the parameter `charger` as its fiducial_return. If only a part of a
///          model has this fiducial_return, the robot goes to that part. A robot without a pack, or in a
///          world without a charger, never charges.
/// needs    a drive, a ranger with more than 8 beams that sees ahead, a fiducial finder, a gripper, a sink
/// source   none: written for Troupe. Stage has the devices, but no example that combines them
engine::ControllerKind collector_controller();

}  // namespace troupe::models
