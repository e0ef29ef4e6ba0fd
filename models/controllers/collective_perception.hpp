#pragma once

#include "engine/kinds/controller_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// The opinion of a robot with the controller `collective_perception`: black or white, the colour that covers
/// more of the floor according to the robot. Robots broadcast their opinions by radio, as one byte each.
enum class FloorOpinion : std::uint8_t {
  black,  ///< 0: more of the floor is black
  white,  ///< 1: more of the floor is white
};

/// Returns the definition of the controller `collective_perception`: robots decide together whether more of a
/// coloured floor is black or white. Each robot has an opinion, black or white. It explores the floor to find
/// the quality of its opinion, shares the opinion by radio, adopts an opinion from the others, and then
/// explores again.
///
/// Names in backquotes are parameters.
///
/// starts    Robots with even ids start with the opinion black, robots with odd ids with the opinion white.
/// explores  The robot explores for a random time: exponentially distributed, with the mean `explore` (s). In
///           each call of the controller it senses the ground below itself. Ground with a brightness (0 to 1)
///           above 0.5 counts as white, other ground as black. The quality of the opinion is the fraction of
///           these samples that have the colour of the opinion.
/// shares    Then the robot broadcasts its opinion for a random time: exponentially distributed, with the
///           mean `share` (s) times the quality. So opinions of high quality are heard more often.
/// adopts    After this time, the robot adopts an opinion from the messages that it heard in the last 3 s of
///           sharing. With the `rule` "majority", it adopts the opinion that most of these messages contain;
///           its own opinion counts as one more message, and after a tie it keeps its opinion. With the
///           `rule` "voter", it adopts the opinion of a message that is selected at random. If it heard no
///           message, it keeps its opinion.
/// walks     While it explores or shares, the robot alternates: it drives straight on for a random time with
///           the mean 10 s, then turns on the spot by a random angle of up to 180 degrees. It turns away from
///           obstacles ahead.
/// LED       If the robot has an LED, the LED is grey while the robot explores. While the robot shares its
///           opinion, the LED has the colour of this opinion, black or white.
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Valentini, Brambilla, Hamann, Dorigo: Collective perception of environmental features in a robot
///           swarm, ANTS 2016: direct modulation of majority-based (DMMD) and of voter-based decisions (DMVD)
/// own       The times and angles of the walk are our own. The way in which messages count is also our own: a
///           robot that is heard in each call of the controller during the 3 s counts once for each of these
///           calls, so 30 times with calls every 0.1 s. The opinion of the robot itself counts only once, so
///           it decides little more than ties
engine::ControllerKind collective_perception_controller();

}  // namespace troupe::models
