#pragma once

#include "engine/kinds/controller_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// The hop count that means "unknown". Robots with the controller `gradient` broadcast their hop counts by
/// radio, as one byte each.
inline constexpr std::uint8_t k_hops_unknown = 255;

/// Returns the definition of the controller `gradient`: robots form a gradient, which means that each robot
/// knows its hop count, the number of radio hops to a beacon. Robots settle (stand still for good) one after
/// another, each within radio range of a settled robot. If walls block the radio, the hops lead around the
/// walls.
///
/// Names in backquotes are parameters. A decision is one call of the controller.
///
/// beacon    A robot with `beacon` true is settled from the start and broadcasts the hop count 0.
/// roams     A robot that is not settled drives straight on and turns away from obstacles ahead. If it hears
///           no settled robot, it drives backwards for up to 2 s in a row, and then forwards again.
/// settles   A roaming robot may settle while the nearest settled robot that it hears is at least `spacing`
///           (m) away. It halts with a probability of 2 % per decision. It settles if the distance is still
///           at least `spacing` when it has stopped. A robot without a ranger is settled from the start.
/// counts    A settled robot computes its hop count from the messages that it hears: the smallest count in
///           the messages, plus 1. It broadcasts its count, or nothing while its count is unknown. If the
///           messages give a smaller count than before, the robot adopts it at once. If they give a larger
///           count in more than `patience` consecutive decisions, the robot adopts the larger count. So a
///           single lost message has no effect, but the counts change when a robot fails.
/// LED       If the robot has an LED, the LED is grey while the robot roams. On a settled robot, its colour
///           goes from red near the beacon to blue at twelve hops or more.
/// needs     a radio; to roam, also a drive and a ranger with more than 8 beams that sees ahead
/// source    hop counts: Nagpal, Shrobe, Bachrach: Organizing a global coordinate system from local
///           information on an ad hoc sensor network, IPSN 2003. Settling within radio range: Payton et al.,
///           Pheromone robotics, Autonomous Robots 11, 2001
engine::ControllerKind gradient_controller();

}  // namespace troupe::models
