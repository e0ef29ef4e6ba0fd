#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Collecting pucks: a robot searches for marked pucks, grips one, carries it to a sink and releases it
/// there. When its pack runs low, it charges first.
///
/// seeks    drives straight on, turning away from obstacles ahead, until its fiducial finder sees a puck
///          (fiducial_return `puck`) that is not at a sink already; drives up to it, slowly for the last half
///          metre, and closes its gripper when the inner beam is broken
/// carries  the puck to the nearest model whose name is `sink`, with or without a number at its end, and
///          opens the gripper there
/// charges  if its pack holds less than 25 %, stands at the nearest model whose fiducial_return is `charger`
///          until it holds 95 %; never without a pack or without a charger
/// needs    a drive, a scanner of more than 8 beams, a fiducial finder, a gripper
/// source   own: Stage has the devices, but no example that combines them
engine::ControllerKind collector_controller();

}  // namespace troupe::models
