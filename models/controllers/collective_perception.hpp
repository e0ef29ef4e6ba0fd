#pragma once

#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The opinion of a robot with the controller `collective_perception`: the colour that, in its opinion,
/// covers more of the floor. Robots broadcast it by radio as one byte.
enum class FloorOpinion : std::uint8_t {
  black,  ///< 0
  white,  ///< 1
};

/// A collective decision on whether more of a coloured floor is black or white.
///
/// starts    Robots with even ids start with the opinion black, robots with odd ids with white.
/// explores  The robot senses the floor for an exponentially distributed time with the mean `explore`. The
///           quality of its opinion is the fraction of these readings that have the colour of its opinion.
/// shares    Then it broadcasts its opinion for an exponentially distributed time with the mean `share` times
///           the quality. At the end it adopts an opinion from the messages of the last 3 s: with the rule
///           `majority` the more frequent opinion, its own included; with `voter` that of a random message.
///           Then it explores again.
/// walks     It drives straight on for random times of mean 10 s, and turns on the spot by up to 180 degrees
///           between them. It turns away from obstacles ahead.
/// LED       If the robot has an LED, it is grey while the robot explores and has the colour of the opinion,
///           black or white, while the robot shares it.
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Valentini, Brambilla, Hamann, Dorigo: Collective perception of environmental features in a robot
///           swarm, ANTS 2016: direct modulation of majority-based (DMMD) and of voter-based decisions (DMVD)
engine::ControllerKind collective_perception_controller();

}  // namespace troupe::models
