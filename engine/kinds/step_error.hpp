#pragma once

#include "base/ids.hpp"

#include <stdexcept>
#include <string>

namespace troupe::engine {

/// Thrown when a step of the world cannot be completed, or the initial state of a body cannot be made. A step
/// computes one tick. The causes:
/// - A command to a drive, the velocity that a drive computes from it, or the pose to which a device moves a
///   joint is not finite.
/// - The code of a sensor, other device, drive or controller, or the callback that a program gave to
///   World::on_decide(), threw an exception.
/// - In the test mode World::hide_beyond_reach(), a device acted on a body beyond its reach
///   (DeviceKind::Prepared::reach_m), or changed a body that its kind must not change (DeviceKind::scope).
/// - If several ranks (threads or processes) compute the world: a device acted on a body beyond the reach of
///   the device, or another rank could not compute the tick (engine/ranks/replica.hpp).
///
/// The text names the number of the tick and the robot, as far as they are known.
class StepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// An error of the drive of a robot. `robot` is the robot whose drive (BodyType::drive) has a command or a
  /// velocity that is not finite.
  StepError(const std::string& text, BodyId robot) : std::runtime_error(text), robot_(robot) {}
  /// The robot whose drive (BodyType::drive) has a command or a velocity that is not finite; of several such
  /// robots, the one with the lowest id. Not valid() for all other errors.
  BodyId robot() const { return robot_; }

 private:
  BodyId robot_;
};

}  // namespace troupe::engine
