#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Chains of standing robots (links) that lead other robots from a nest to a prey.
///
/// sends     two bytes by radio: a number, and 1 if a path leads on from here to the prey. The nest sends 0,
///           a link one more than the link before it, the prey 255
/// searches  while it hears none of these, it drives straight on and turns away from obstacles ahead
/// explores  it goes from the nearest link that it hears to the next one, outwards. If there is no next
///           link, or at the nest none within `spacing` of the place for a first link, it goes to the place
///           `spacing` beyond the last link, in line with the one before that, and becomes the next link
///           there with probability `joins` per decision
/// leaves    with probability `leaves` per decision, a link that hears neither a next link nor the prey; a
///           link that no longer hears a link of the number before its own; and of two links of the same
///           number in one place, the one with the higher id. It goes back along the chain, around the nest
///           for a while, and explores again
/// path      a link that hears the prey, or a next link with a path, has a path, and stays
/// shows     by an LED, if it has one: grey while it explores; as a link, blue, green and yellow in turn
/// needs     a radio with a payload of 2 bytes or more; a robot also a drive and a scanner of more than
///           8 beams
/// source    Nouyan, Campo, Dorigo: Path formation in a robot swarm: self-organized strategies to find
///           your way home, Swarm Intelligence 2, 2008; Nouyan, Gross, Bonani, Mondada, Dorigo: Teamwork in
///           self-organized robot colonies, IEEE Transactions on Evolutionary Computation 13, 2009. In the
///           papers, cameras see three colours in turn, which tell the direction of a chain; here, numbers do
engine::ControllerKind chain_controller();

}  // namespace troupe::models
