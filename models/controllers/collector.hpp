#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Collecting pucks: a robot looks for marked pucks, grips one, carries it to a sink and lets go of it there;
/// when its pack runs low it charges first.
///
/// seeks    drives straight on, turning from what its scanner sees ahead, until its fiducial finder shows a
///          puck (fiducial_return `puck`) that does not lie at a sink already; drives up to it, slowly for
///          the last half metre, and closes its gripper when that feels it between its paddles
/// carries  to the nearest model whose name is `sink`, with or without a number behind it, and opens there
/// charges  below 25 % stands at the nearest model whose fiducial_return is `charger` until it holds 95 %;
///          without a pack, or where there is no charger, it never does
/// needs    a drive, a scanner of more than 8 beams, a fiducial finder, a gripper
/// made by  us: Stage has the parts, and no example that puts them together
engine::ControllerKind collector_controller();

}  // namespace troupe::models
