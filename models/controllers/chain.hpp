#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `chain`: robots search for a prey and form chains from a nest to
/// the prey. A chain is a line of standing robots, called links. Each link hears the next one by radio.
///
/// The nest and the prey are bodies that also have this controller. They do not move. The parameter `role` is
/// "nest" for the nest, "prey" for the prey and "robot" (the default) for the robots. The nest counts as the
/// link with the number 0 of every chain. The next link has the number 1, and so on. A robot that is not a
/// link is called an explorer. `spacing` (m), `joins` and `leaves` are parameters. A decision is one call of
/// the controller.
///
/// sends     The nest, the links and the prey broadcast two bytes: their number (the prey: 255), and 1 if
///           they have a path, else 0. The prey always sends 1. Explorers send nothing.
/// path      A link has a path if its chain reaches the prey. This means: the link hears the link before it,
///           and it also hears the prey or a next link that has a path. The nest has a path if it hears the
///           prey or a link with the number 1 that has a path.
/// explores  An explorer goes outwards along a chain, from the nearest link that it hears to the next link.
///           If it hears no next link, it goes to the place for a new link: `spacing` beyond the last link,
///           in line with the last two links. If it hears only one link, the place is on the line from this
///           link through the robot. At the place, the explorer becomes the new link with the probability
///           `joins` per decision. An explorer that hears no link drives straight on. All explorers turn away
///           from obstacles ahead.
/// branches  If the nearest link is the nest, an explorer may also start another chain, at the place on the
///           line from the nest through the robot that is `spacing` from the nest. It does so if the nearest
///           link with the number 1 is more than `spacing` from this place.
/// leaves    A link becomes an explorer again in three cases:
///           - It is the last link and its chain has not reached the prey (it hears the link before it but no
///             next link, and has no path). It leaves with the probability `leaves` per decision.
///           - It has not heard the link before it for more than 20 decisions.
///           - It hears a link with the same number and a lower id, nearer than half of `spacing`.
///           The robot then goes back along the chain to the nest, drives around the nest for up to 30 s, and
///           explores.
/// LED       If the robot has an LED, the LED is grey while the robot explores. The LEDs of the links of a
///           chain are blue, green and yellow in turn.
/// needs     in every role, a radio with a payload of 2 bytes or more; with the role "robot", also a drive,
///           and a ranger with more than 8 beams that sees ahead
/// source    Nouyan, Campo, Dorigo: Path formation in a robot swarm: self-organized strategies to find your
///           way home, Swarm Intelligence 2, 2008; Nouyan, Gross, Bonani, Mondada, Dorigo: Teamwork in
///           self-organized robot colonies, IEEE Transactions on Evolutionary Computation 13, 2009. In the
///           papers, cameras see three colours in turn, which tell the direction of a chain; here the numbers
///           of the links tell the direction
engine::ControllerKind chain_controller();

}  // namespace troupe::models
