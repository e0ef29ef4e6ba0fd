#pragma once

#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The opinion of a robot with the controller `collective_perception`: the colour that it takes for the more
/// frequent one of the floor. Broadcast by radio as one byte.
enum class FloorOpinion : std::uint8_t {
  black,  ///< 0
  white,  ///< 1
};

/// A collective decision on whether more of a coloured floor is black or white.
///
/// starts    robots with even ids with the opinion black, robots with odd ids with white
/// explores  for an exponentially distributed time of mean `explore`, s: senses the floor. The quality of its
///           opinion is the fraction of the readings that have the colour of its opinion
/// shares    for an exponentially distributed time of mean `share` times the quality, s: broadcasts its
///           opinion. Then it adopts a new one from the messages of the last 3 s of that time: with
///           `majority` the more frequent opinion, its own included; with `voter` that of a random message
/// walks     straight on, for times of mean 10 s, then turns on the spot by up to 180 degrees; turns away
///           from obstacles ahead
/// shows     its opinion by an LED, if it has one: black or white; grey while it explores
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Valentini, Brambilla, Hamann, Dorigo: Collective perception of environmental features in a robot
///           swarm, ANTS 2016: direct modulation of majority-based (DMMD) and of voter-based decisions (DMVD)
engine::ControllerKind collective_perception_controller();

}  // namespace troupe::models
