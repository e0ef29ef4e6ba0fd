#pragma once

#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/kinds.hpp"
#include "sensors/fiducial.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::models {

/// What a fiducial finder reads, for controllers: the fields of sensors/fiducial.hpp, with angles from
/// straight ahead of the drive.
class FiducialReadings {
 public:
  FiducialReadings() = default;
  /// Of a device that a controller chose, which must be a fiducial finder.
  explicit FiducialReadings(const engine::DeviceInfo& finder) : finder_heading_(finder.pose.heading) {}

  /// Targets that have an entry; the nearest comes first. There may be more in sight.
  std::size_t count(const engine::Readings& seen) const {
    return std::min<std::size_t>(seen.field<std::uint32_t>(sensors::k_fiducial_count)[0],
                                 seen.field<std::int32_t>(sensors::k_fiducial_id).size());
  }
  /// Its fiducial_return; 0 where it is too far to be read.
  std::int32_t id(const engine::Readings& seen, std::size_t target) const {
    return seen.field<std::int32_t>(sensors::k_fiducial_id)[target];
  }
  /// To its origin, m.
  float range(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(sensors::k_fiducial_range)[target];
  }
  /// Of its origin, rad, from straight ahead of the drive.
  double bearing(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(sensors::k_fiducial_bearing)[target]);
  }
  /// Its own, rad, in the frame of the drive.
  double heading(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(sensors::k_fiducial_heading)[target]);
  }
  /// Of its origin, m, world frame.
  Vec2 position(const engine::Readings& seen, std::size_t target) const {
    const std::span<const double> pose = seen.field<double>(sensors::k_fiducial_pose).subspan(4 * target, 2);
    return {pose[0], pose[1]};
  }

 private:
  /// From the sensor's frame; of a finder that looks ahead the reading as it is.
  double turned(float angle) const {
    return finder_heading_ == 0 ? angle : wrap_angle(finder_heading_ + angle);
  }

  double finder_heading_ = 0;  // rad, in the frame of the drive
};

}  // namespace troupe::models
