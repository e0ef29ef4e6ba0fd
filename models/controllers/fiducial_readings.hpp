#pragma once

#include "base/assert.hpp"
#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/kinds.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace troupe::models {

/// What a fiducial finder reads, for controllers. Models and sensors do not know one another, so the fields
/// are found once by their names, which are those of recordings too; sensors/fiducial.hpp says what is in
/// them.
class FiducialReadings {
 public:
  FiducialReadings() = default;
  /// Of a device that a controller chose, which must be a fiducial finder.
  explicit FiducialReadings(const engine::DeviceInfo& finder)
      : count_(field(finder.prepared, "count")),
        id_(field(finder.prepared, "id")),
        range_(field(finder.prepared, "range")),
        bearing_(field(finder.prepared, "bearing")),
        heading_(field(finder.prepared, "heading")),
        pose_(field(finder.prepared, "pose")),
        finder_heading_(finder.pose.heading) {}

  /// Targets that have an entry; the nearest comes first. There may be more in sight.
  std::size_t count(const engine::Readings& seen) const {
    return std::min<std::size_t>(seen.field<std::uint32_t>(count_)[0], seen.field<std::int32_t>(id_).size());
  }
  /// Its fiducial_return; 0 where it is too far to be read.
  std::int32_t id(const engine::Readings& seen, std::size_t target) const {
    return seen.field<std::int32_t>(id_)[target];
  }
  /// To its origin, m.
  float range(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(range_)[target];
  }
  /// Of its origin, rad, from straight ahead of the drive.
  double bearing(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(bearing_)[target]);
  }
  /// Its own, rad, in the frame of the drive.
  double heading(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(heading_)[target]);
  }
  /// Of its origin, m, world frame.
  Vec2 position(const engine::Readings& seen, std::size_t target) const {
    const std::span<const double> pose = seen.field<double>(pose_).subspan(4 * target, 2);
    return {pose[0], pose[1]};
  }

 private:
  /// From the sensor's frame; of a finder that looks ahead the reading as it is.
  double turned(float angle) const {
    return finder_heading_ == 0 ? angle : wrap_angle(finder_heading_ + angle);
  }
  static std::size_t field(const engine::DeviceKind::Prepared& finder, std::string_view name) {
    const auto is_it = [name](const engine::StateField& field) { return field.name == name; };
    const auto found = std::ranges::find_if(finder.percepts, is_it);
    TROUPE_ASSERT(found != finder.percepts.end());
    return static_cast<std::size_t>(found - finder.percepts.begin());
  }

  std::size_t count_ = 0;
  std::size_t id_ = 0;
  std::size_t range_ = 0;
  std::size_t bearing_ = 0;
  std::size_t heading_ = 0;
  std::size_t pose_ = 0;
  double finder_heading_ = 0;  // rad, in the frame of the drive
};

}  // namespace troupe::models
