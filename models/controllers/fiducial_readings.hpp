#pragma once

#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/kinds/kinds.hpp"
#include "sensors/fiducial.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::models {

/// Gives a controller access to the readings of a fiducial finder, with angles in the frame of the drive. A
/// target is a model (a body or a part of a body) that the finder detects. The argument `seen` of the
/// functions holds the readings of the finder. The argument `target` is the index of a target, from 0 to
/// count() - 1, the nearest target first.
class FiducialReadings {
 public:
  FiducialReadings() = default;
  /// finder: a device that the controller chose, of kind `fiducial`.
  explicit FiducialReadings(const engine::DeviceInfo& finder) : finder_heading_(finder.pose.heading) {}

  /// Number of targets in the readings. More targets may be in sight than the readings have room for: the
  /// readings then hold the nearest of them.
  std::size_t count(const engine::Readings& seen) const {
    return std::min<std::size_t>(seen.field<std::uint32_t>(sensors::k_fiducial_count)[0],
                                 seen.field<std::int32_t>(sensors::k_fiducial_id).size());
  }
  /// The fiducial_return of the target, by which it is recognised; 0 if the target is too far away to be
  /// recognised.
  std::int32_t id(const engine::Readings& seen, std::size_t target) const {
    return seen.field<std::int32_t>(sensors::k_fiducial_id)[target];
  }
  /// Horizontal distance from the finder to the origin of the target, m.
  float range(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(sensors::k_fiducial_range)[target];
  }
  /// Bearing of the origin of the target from the finder, rad, counter-clockwise from straight ahead of the
  /// drive.
  double bearing(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(sensors::k_fiducial_bearing)[target]);
  }
  /// Heading of the target, rad, counter-clockwise from straight ahead of the drive.
  double heading(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(sensors::k_fiducial_heading)[target]);
  }
  /// Position of the origin of the target, m, world frame.
  Vec2 position(const engine::Readings& seen, std::size_t target) const {
    const std::span<const double> pose = seen.field<double>(sensors::k_fiducial_pose).subspan(4 * target, 2);
    return {pose[0], pose[1]};
  }

 private:
  /// Converts an angle (rad) from the frame of the finder to the frame of the drive. If the finder faces
  /// straight ahead, it returns the angle unchanged.
  double turned(float angle) const {
    return finder_heading_ == 0 ? angle : wrap_angle(finder_heading_ + angle);
  }

  double finder_heading_ = 0;  // rad, in the frame of the drive
};

}  // namespace troupe::models
