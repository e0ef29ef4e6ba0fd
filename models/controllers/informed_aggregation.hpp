#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Aggregation on black and white sites, by robots of which some are informed: these stop only on sites of
/// one colour.
///
/// walks     straight on, and turns by a random angle away from obstacles nearer than `min_front`
/// enters    on a site of a colour on which it may stop, drives on for a random time of at most `enter`, so
///           that the first robots do not block the border, and then stands, if it is still on that colour
/// stands    broadcasts the colour; leaves at the rate `leave` exp(-`others` n), 1/s, where n is the number
///           of robots that it hears on the same colour; then it does not stop again before it has been on
///           ground that is neither black nor white
/// sees      black below a quarter of full brightness, white above three quarters
/// stuck     backs out if other robots block it
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Firat, Ferrante, Cambier, Tuci: Self-organised aggregation in swarms of robots with informed
///           robots, TPNC 2018. Robots stay longer the more others are near, as cockroaches do:
///           Jeanson et al., Self-organized aggregation in cockroaches, Animal Behaviour 69, 2005; Garnier et
///           al., The embodiment of cockroach aggregation behavior in a group of micro-robots, Artificial
///           Life 14, 2008. The form of the law and its constants are our own
engine::ControllerKind informed_aggregation_controller();

}  // namespace troupe::models
