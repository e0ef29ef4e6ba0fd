#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The opinion of a robot with the controller `collective_perception`: the colour that the robot takes to
/// cover more of the floor. Robots broadcast their opinions by radio, as one byte each.
enum class FloorOpinion : std::uint8_t {
  black,  ///< 0: more of the floor is black
  white,  ///< 1: more of the floor is white
};

/// Returns the definition of the controller `collective_perception`: a collective decision on whether more of
/// a coloured floor is black or white.
///
/// starts    Robots with even ids start with the opinion black, robots with odd ids with the opinion white.
/// explores  The robot senses the floor for an exponentially distributed time with the mean `explore` (s, a
///           parameter). The quality of the opinion is the fraction of the ground readings of this time that
///           have the colour of the opinion. A reading above half of the full brightness is white, else
///           black.
/// shares    Then it broadcasts its opinion for an exponentially distributed time. The mean of this time is
///           the parameter `share` (s) times the quality. At the end it adopts an opinion from the messages
///           that it heard in the last 3 s. If the parameter `rule` is "majority", it adopts the more
///           frequent opinion. Its own opinion counts as one message, and after a tie it keeps its opinion.
///           If `rule` is "voter", it adopts the opinion in a random message. Without a message, it keeps its
///           opinion. Then it explores again.
/// walks     While it explores or shares, it drives straight on for random times of mean 10 s. Between them
///           it turns on the spot by up to 180 degrees. It turns away from obstacles ahead.
/// LED       If the robot has an LED, the LED is grey while the robot explores. While the robot shares its
///           opinion, the LED has the colour of this opinion, black or white.
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Valentini, Brambilla, Hamann, Dorigo: Collective perception of environmental features in a robot
///           swarm, ANTS 2016: direct modulation of majority-based (DMMD) and of voter-based decisions (DMVD)
engine::ControllerKind collective_perception_controller();

}  // namespace troupe::models
