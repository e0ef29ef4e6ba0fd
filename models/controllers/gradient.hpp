#pragma once

#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// Hop count that means "unknown". A robot with the controller `gradient` broadcasts its hop count as one
/// byte.
inline constexpr std::uint8_t k_hops_unknown = 255;

/// A gradient by radio: robots settle one after another within radio range of settled ones, and each learns
/// its number of hops to a beacon; around walls, if the radio does not pass them.
///
/// beacon    sends 0 hops, and stands still
/// settles   while the nearest settled robot that it hears is at least `spacing` away, a roaming robot halts
///           with a probability of 2 % per decision, and settles if that still holds once it stands; without
///           a scanner it is settled from the start
/// counts    a settled robot sends one more than the smallest count that it hears. It forgets a count that
///           no message has confirmed for `patience` decisions: so lost messages have no effect, but lost
///           robots do
/// shows     by an LED, if it has one: red near the beacon, blue from twelve hops on; grey while it roams
/// roams     drives straight on, turning away from obstacles ahead. While it hears no settled robot, it
///           drives backwards for a while, then roams freely
/// needs     a radio; to roam, a drive and a scanner of more than 8 beams
/// source    hop counts: Nagpal, Shrobe, Bachrach: Organizing a global coordinate system from local
///           information on an ad hoc sensor network, IPSN 2003. Settling within radio range: Payton et al.,
///           Pheromone robotics, Autonomous Robots 11, 2001
engine::ControllerKind gradient_controller();

}  // namespace troupe::models
