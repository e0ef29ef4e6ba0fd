#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Chains of standing robots that lead other robots from a nest to a prey. A standing robot in a chain is a
/// link. Links are numbered from the nest, which has the number 0: the next link after link n has the number
/// n + 1. A link has a path if the chain leads on from it to the prey.
///
/// sends     Nest, links and prey broadcast two bytes: their number, and 1 if they have a path. The number of
///           the prey is 255.
/// searches  A robot that hears none of these messages drives straight on and turns away from obstacles.
/// explores  A robot that hears links goes from the nearest link to the next one, outwards. At the end of a
///           chain it goes to the place for a new link: `spacing` beyond the last link, in line with the last
///           two. At the nest it may also start a new chain: at a place `spacing` from the nest that is more
///           than `spacing` from the nearest first link. At the place it becomes a link with probability
///           `joins` per decision.
/// leaves    Three kinds of links leave the chain. A link without a path that hears no next link leaves with
///           probability `leaves` per decision. A link leaves when it no longer hears the link before it. If
///           two links of the same number are in one place, the one with the higher id leaves. Such a robot
///           goes back along the chain, then around the nest for a while, and explores again.
/// path      A link has a path if it hears the prey, or if it hears the next link and that one has a path. A
///           link with a path stays.
/// LED       If the robot has an LED, it is grey while the robot explores, and blue, green or yellow in turn
///           along the links of a chain.
/// needs     a radio with a payload of 2 bytes or more; a robot (role `robot`) also needs a drive and a
///           scanner of more than 8 beams
/// source    Nouyan, Campo, Dorigo: Path formation in a robot swarm: self-organized strategies to find your
///           way home, Swarm Intelligence 2, 2008; Nouyan, Gross, Bonani, Mondada, Dorigo: Teamwork in
///           self-organized robot colonies, IEEE Transactions on Evolutionary Computation 13, 2009. In the
///           papers, cameras see three colours in turn, which tell the direction of a chain; here the numbers
///           tell it
engine::ControllerKind chain_controller();

}  // namespace troupe::models
