#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The hop count that means "unknown". Robots with the controller `gradient` broadcast their hop counts as
/// one byte each.
inline constexpr std::uint8_t k_hops_unknown = 255;

/// Returns the definition of the controller `gradient`: robots exchange hop counts by radio and so form a
/// gradient. Robots settle one after another within radio range of settled robots, and each robot learns its
/// number of hops to a beacon. If walls stop the radio, the hops lead around the walls.
///
/// beacon    A robot whose parameter `beacon` is true stands still and broadcasts the hop count 0.
/// roams     A robot that is not settled drives straight on and turns away from obstacles ahead. If it hears
///           no settled robot, it drives backwards for up to 2 s in a row, and then forwards again.
/// settles   While the nearest settled robot that it hears is at least `spacing` (m) away, a roaming robot
///           halts with a probability of 2 % per call of the controller. It settles if the distance is still
///           at least `spacing` when it has stopped. A robot without a ranger is settled from the start.
/// counts    The hop count of a settled robot is one more than the smallest count that the robot hears. The
///           robot broadcasts its count, or nothing while the count is unknown. It replaces a count that no
///           message has confirmed for `patience` decisions (calls of the controller) by the count that
///           follows from the present messages. So a single lost message has no effect, but counts change
///           after a robot has failed.
/// LED       If the robot has an LED, the LED is grey while the robot roams. On a settled robot, the colour
///           of the LED goes from red near the beacon to blue at twelve hops or more.
/// needs     a radio; to roam, also a drive and a ranger with more than 8 beams that sees ahead
/// source    hop counts: Nagpal, Shrobe, Bachrach: Organizing a global coordinate system from local
///           information on an ad hoc sensor network, IPSN 2003. Settling within radio range: Payton et al.,
///           Pheromone robotics, Autonomous Robots 11, 2001
engine::ControllerKind gradient_controller();

}  // namespace troupe::models
