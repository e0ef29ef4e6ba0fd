#pragma once

#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// What a robot with the controller `collective_perception` holds to be the more frequent colour of the
/// floor, and says by radio, one byte.
enum class FloorOpinion : std::uint8_t {
  black,  ///< 0
  white,  ///< 1
};

/// A collective decision on a coloured floor: is more of it black or white?
///
/// begins    robots of even ids for black, of odd ids for white
/// explores  for a time drawn from an exponential distribution of mean `explore_s`: looks at the floor, and
///           counts how often it has the colour of its opinion; that share is the opinion's quality
/// shares    for a time of mean `share_s` times the quality: says its opinion. Then it takes a new one, from
///           what it heard in the last 3 s of that time: of `majority` the more frequent one, its own
///           included; of `voter` that of a message taken at random
/// walks     straight on, for times of mean 10 s, then turns on the spot by up to 180 degrees; turns away
///           from what its scanner sees ahead
/// shows     its opinion with an LED, where it has one: black or white; grey while it explores
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Valentini, Brambilla, Hamann, Dorigo: Collective perception of environmental features in a robot
///           swarm, ANTS 2016: direct modulation of majority-based (DMMD) and of voter-based decisions (DMVD)
engine::ControllerKind collective_perception_controller();

}  // namespace troupe::models
