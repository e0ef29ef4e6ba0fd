#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Chains of robots that stand and lead the others from a nest to a prey.
///
/// says      by radio, two bytes: a number, and 1 where a path to the prey begins behind it. The nest says 0,
///           a link of a chain one more than the link it stands at, the prey 255
/// searches  who hears none of them goes straight on, and turns away from what its scanner sees ahead
/// explores  goes from the link that it hears nearest to the next one, outwards. Where there is none, or at
///           the nest none within `spacing` of where a first link would stand, it goes `spacing` beyond the
///           last one, in line with the one before it, and with the chance `joins` in a decision stands there
///           as the next link
/// leaves    a link that hears no further one, and not the prey, with the chance `leaves`; one that hears
///           no link of the number before its own; and of two of one number in one place the one of the
///           higher id. It goes back along the chain, round the nest for a while, and explores again
/// path      a link that hears the prey, or a next link with a path, has one: it stays
/// shows     with an LED, where it has one: grey while it explores; as a link blue, green and yellow in turn
/// needs     a radio with a payload of 2 bytes or more; a robot also a drive and a scanner of more than
///           8 beams
/// source    Nouyan, Campo, Dorigo: Path formation in a robot swarm: self-organized strategies to find
///           your way home, Swarm Intelligence 2, 2008; Nouyan, Gross, Bonani, Mondada, Dorigo: Teamwork in
///           self-organized robot colonies, IEEE Transactions on Evolutionary Computation 13, 2009. There
///           three colours in turn tell which way a chain leads, which cameras see; here it is numbers
engine::ControllerKind chain_controller();

}  // namespace troupe::models
