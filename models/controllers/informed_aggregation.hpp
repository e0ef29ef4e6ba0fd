#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `informed_aggregation`: aggregation on black and white sites of
/// the ground. Some of the robots are informed: they stop only on sites of the colour that the parameter
/// `informed` names (black or white). The other robots (`informed` is "no") stop on sites of both colours.
///
/// walks     A robot drives straight on. If its ranger sees an obstacle ahead within `min_front` (m, a
///           parameter), the robot turns on the spot, away from the nearer side, by a random angle of 90 to
///           180 degrees.
/// enters    On a site where the robot may stop, it drives on for a random time of at most `enter` (s, a
///           parameter), so that the first robots do not block the border. Then the robot stops if it is
///           still on the same colour.
/// stands    While it stands on a site, it broadcasts the colour of the site. It leaves with the rate `leave`
///           exp(-`others` n), in 1/s. `leave` (1/s) and `others` are parameters, and n is the number of
///           messages that it hears from robots on sites of the same colour. It does not stop again before it
///           has been on ground that is neither black nor white.
/// colours   Ground is black below a quarter of full brightness, and white above three quarters.
/// stuck     If a walking robot does not move, it drives in the opposite direction for a while
///           (Evasion::escapes()).
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Firat, Ferrante, Cambier, Tuci: Self-organised aggregation in swarms of robots with informed
///           robots, TPNC 2018. Robots stay longer the more other robots are near, as cockroaches do: Jeanson
///           et al., Self-organized aggregation in cockroaches, Animal Behaviour 69, 2005; Garnier et al.,
///           The embodiment of cockroach aggregation behavior in a group of micro-robots, Artificial Life 14,
///           2008. The formula of the rate of leaving and its constants are our own
engine::ControllerKind informed_aggregation_controller();

}  // namespace troupe::models
