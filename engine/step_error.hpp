#pragma once

#include "base/ids.hpp"

#include <stdexcept>
#include <string>

namespace troupe::engine {

/// Thrown when a step cannot be completed: a command to the drive of a robot, the velocity that the drive
/// computes from it, or the goal of a joint is not a finite number, a function of a kind (of a sensor, other
/// device, drive or controller) threw an exception, a check of World::hide_beyond_reach() failed, or another
/// rank could not compute the tick (engine/replica.hpp). The text names the tick and the robot, as far as
/// they are known.
class StepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// robot: the robot whose command or velocity is not a finite number
  StepError(const std::string& text, BodyId robot) : std::runtime_error(text), robot_(robot) {}
  /// The robot whose command or velocity is not a finite number (of several, the one with the lowest id); not
  /// valid() for all other errors.
  BodyId robot() const { return robot_; }

 private:
  BodyId robot_;
};

}  // namespace troupe::engine
