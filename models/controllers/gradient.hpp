#pragma once

#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// What a robot with the controller `gradient` says: its hop count, one byte.
inline constexpr std::uint8_t k_hops_unknown = 255;

/// A gradient over radio: robots settle one behind another, always in touch, and each knows over how many
/// hops a beacon is reached; around walls, where the radio does not pass them.
///
/// beacon    says 0 hops, and stands
/// settles   while the nearest settled one that it hears is `spacing` or farther away, one that roams halts,
///           with a chance of 2 % in each decision, and settles if that is so still when it stands; without
///           a scanner it is settled from the start
/// counts    a settled robot says one more than the least count that it hears. A count that no robot has
///           confirmed for `patience` decisions is forgotten, so that lost messages do not matter and lost
///           robots do
/// shows     with an LED, where it has one: red near the beacon, blue from twelve hops on; grey while it
///           roams
/// roams     drives straight on, turning from what its scanner sees ahead; backwards while it hears no
///           settled robot, for a while, then anywhere
/// needs     a radio; to roam, a drive and a scanner of more than 8 beams
/// source    hop counts: Nagpal, Shrobe, Bachrach: Organizing a global coordinate system from local
///           information on an ad hoc sensor network, IPSN 2003. Settling in touch: Payton et al., Pheromone
///           robotics, Autonomous Robots 11, 2001
engine::ControllerKind gradient_controller();

}  // namespace troupe::models
