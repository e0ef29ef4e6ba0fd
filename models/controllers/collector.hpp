#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Collecting pucks: a robot searches for marked pucks, grips one, carries it to a sink and releases it
/// there. When its power pack runs low while it searches, it charges first.
///
/// seeks    The robot drives straight on and turns away from obstacles ahead until its fiducial finder sees a
///          puck (fiducial_return `puck`) that is not yet at a sink. It drives up to the puck, slowly for the
///          last half metre, and closes its gripper when the puck breaks the inner beam.
/// carries  It takes the puck to the nearest model whose name is the parameter `sink`, with or without digits
///          after it, and opens the gripper there.
/// charges  If its pack holds less than 25 %, it goes to the nearest model whose fiducial_return is `charger`
///          and stands there until the pack holds 95 %. A robot without a pack, or in a world without a
///          charger, never charges.
/// needs    a drive, a scanner of more than 8 beams, a fiducial finder, a gripper
/// source   none: written for Troupe. Stage has the devices, but no example that combines them
engine::ControllerKind collector_controller();

}  // namespace troupe::models
