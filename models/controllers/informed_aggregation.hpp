#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Aggregation on sites that are black or white, by robots of which some are informed: these stop on sites of
/// one colour alone.
///
/// walks     straight on, and turns by a random angle away from what its scanner sees nearer than `min_front`
/// enters    on a site of a colour on which it may stop: goes on for a random time of `enter` at most, so
///           that who comes first does not close the border, and then stands, if it is still on that colour
/// stands    says by radio on which colour; leaves with `leave` exp(-`others` n) per second, where n is how
///           many it hears that stand on the same colour; then it stops nowhere before it has been on a floor
///           that is neither black nor white
/// sees      black below a quarter of full brightness, white above three quarters
/// stuck     between others, it backs out
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Firat, Ferrante, Cambier, Tuci: Self-organised aggregation in swarms of robots with informed
///           robots, TPNC 2018. That the more stand near the longer a robot stays is from cockroaches:
///           Jeanson et al., Self-organized aggregation in cockroaches, Animal Behaviour 69, 2005; Garnier et
///           al., The embodiment of cockroach aggregation behavior in a group of micro-robots, Artificial
///           Life 14, 2008. The form of the law and its numbers are ours
engine::ControllerKind informed_aggregation_controller();

}  // namespace troupe::models
