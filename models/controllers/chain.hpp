#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `chain`: chains of standing robots that lead other robots from a
/// nest to a prey. The nest and the prey are also objects with this controller: its parameter `role` is
/// `robot` (the default), `nest` or `prey`. The nest and the prey only broadcast, and do not move. A standing
/// robot in a chain is a link. Links are numbered from the nest, which has the number 0: the next link after
/// link n has the number n + 1. A link has a path if the chain leads on from this link to the prey.
///
/// sends     The nest, the links and the prey each broadcast two bytes: their number, and 1 if they have a
///           path, else 0. The prey sends 255 and 1.
/// searches  A robot that hears neither the nest nor a link drives straight on and turns away from obstacles.
/// explores  A robot that hears links goes from the nearest link to the next one, outwards. At the end of a
///           chain it goes to the place for a new link, which is the distance `spacing` (m, a parameter)
///           beyond the last link. The place is in line with the last two links. If the robot hears only the
///           last link, the place is on the line from this link to the robot. At the nest it may also start a
///           new chain: at a place `spacing` from the nest that is more than `spacing` from the nearest first
///           link (a link with the number 1). At the place for a new link, it becomes a link with probability
///           `joins` per decision (call of the controller).
/// leaves    A link leaves the chain in three cases. If it has no path and hears no next link, it leaves with
///           probability `leaves` per decision. If it has not heard the previous link for more than 20
///           decisions, it leaves. If two links of the same number are nearer to each other than half of
///           `spacing`, the link with the higher id leaves. A robot that leaves goes back along the chain,
///           then around the nest for up to 30 s, and explores again.
/// path      A link has a path if it hears the link before it and, in addition, the prey or a next link that
///           has a path. The nest, which has no link before it, has a path if it hears the prey or a first
///           link that has a path.
/// LED       If the robot has an LED, the LED is grey while the robot explores. The LEDs of the links of a
///           chain are blue, green and yellow in turn.
/// needs     in every role, a radio with a payload of 2 bytes or more; with the role `robot`, also a drive,
///           and a ranger with more than 8 beams that sees ahead
/// source    Nouyan, Campo, Dorigo: Path formation in a robot swarm: self-organized strategies to find your
///           way home, Swarm Intelligence 2, 2008; Nouyan, Gross, Bonani, Mondada, Dorigo: Teamwork in
///           self-organized robot colonies, IEEE Transactions on Evolutionary Computation 13, 2009. In the
///           papers, cameras see three colours in turn, which tell the direction of a chain; here the numbers
///           of the links tell the direction
engine::ControllerKind chain_controller();

}  // namespace troupe::models
