#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `informed_aggregation`: robots gather on sites, which are black
/// and white areas of the ground. Some of the robots are informed: their parameter `informed` is "black" or
/// "white", and they stop only on sites of this colour. The other robots (`informed` is "no") stop on sites
/// of both colours.
///
/// Names in backquotes are parameters.
///
/// walks     A robot drives straight on. If its ranger sees an obstacle ahead within `min_front` (m), the
///           robot turns on the spot, away from the nearer side, by a random angle of 90 to 180 degrees.
/// stops     When a robot drives onto a site where it may stop, it drives on for a random time of at most
///           `enter` (s), so that it does not block the edge of the site for other robots. If it is still on
///           this colour then, it stops.
/// stays     While it stands on a site, the robot broadcasts the colour of the site. In each call of the
///           controller, it leaves with the probability `leave` exp(-`others` n) T. `leave` is in 1/s and
///           `others` is a number. n is the number of messages that it hears from robots on sites of the same
///           colour, and T is the time between two calls, s. So the robot stays longer the more robots are
///           near.
/// leaves    After it has left a site, the robot does not stop again until it has been on ground that is
///           neither black nor white.
/// colours   Ground is black if its brightness (0 to 1) is below 0.25, and white if it is above 0.75.
/// stuck     A walking robot that is stuck at an obstacle backs out (Evasion::escapes()).
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Firat, Ferrante, Cambier, Tuci: Self-organised aggregation in swarms of robots with informed
///           robots, TPNC 2018. Robots stay longer the more other robots are near, as cockroaches do: Jeanson
///           et al., Self-organized aggregation in cockroaches, Animal Behaviour 69, 2005; Garnier et al.,
///           The embodiment of cockroach aggregation behavior in a group of micro-robots, Artificial Life 14,
///           2008. The formula of the probability of leaving and its constants are our own
engine::ControllerKind informed_aggregation_controller();

}  // namespace troupe::models
