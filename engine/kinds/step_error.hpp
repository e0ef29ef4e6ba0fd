#pragma once

#include "base/ids.hpp"

#include <stdexcept>
#include <string>

namespace troupe::engine {

/// Thrown when a step of the world cannot be completed, or when the initial state of a body cannot be
/// computed. A step computes one tick. The text names the number of the tick and the robot, as far as they
/// are known. The causes:
/// - A number is not finite: in a command to a drive, in the velocity that a drive computes or starts with,
///   in the odometry estimate that follows from this velocity, or in a pose to which a device moves a joint;
///   or a command to an actuator is NaN.
/// - The code of a sensor, other device, drive or controller threw an exception. It is nested in the
///   StepError (std::rethrow_if_nested()).
/// - A device uses a joint that its kind does not declare (DeviceKind::joints).
/// - A device emitted an effect that it must not emit, or two effects with the same number
///   (Effect::sequence).
/// - The callback that a program gave to World::on_decide() threw an exception. It is nested likewise.
/// - In the test mode World::hide_beyond_reach(), a device acted on a body beyond the reach of the device
///   (DeviceKind::Prepared::reach_m), or changed a body that its kind must not change (DeviceKind::scope).
///
/// If several ranks (threads or processes) compute the world together, there are more causes:
/// - The ranks divide the bodies among themselves, and a device acted on a body beyond the reach of the
///   device.
/// - The ranks divide the bodies among themselves, and robots pushed a body too far in one tick.
/// - Another rank could not compute the tick (engine/ranks/replica.hpp).
class StepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// An error of the drive (BodyType::drive) of a robot: the command to the drive, the velocity of the drive
  /// or the odometry estimate is not finite.
  StepError(const std::string& text, BodyId robot) : std::runtime_error(text), robot_(robot) {}
  /// The robot whose drive (BodyType::drive) has a command, a velocity or an odometry estimate that is not
  /// finite. If there are several, the one with the lowest id. Not valid() for all other errors.
  BodyId robot() const { return robot_; }

 private:
  BodyId robot_;
};

}  // namespace troupe::engine
