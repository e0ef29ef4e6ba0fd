#pragma once

#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "sensors/fiducial.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::models {

/// Gives a controller access to the readings of a fiducial finder (a sensor that detects marked objects),
/// with angles in the frame of the drive. A target is a model (a body or a part of a body) that the finder
/// detects. The argument `seen` of the functions holds the readings of the finder. The argument `target` is
/// the index of a target, from 0 to count() - 1, the nearest target first.
class FiducialReadings {
 public:
  FiducialReadings() = default;
  /// finder: a fiducial finder (a device of the kind `fiducial`) that the controller uses.
  explicit FiducialReadings(const engine::DeviceInfo& finder) : finder_heading_(finder.pose.heading) {}

  /// Number of targets in the readings. More targets may be in sight than the readings have room for: the
  /// readings then hold the nearest of them.
  std::size_t count(const engine::Readings& seen) const {
    return std::min<std::size_t>(seen.field<std::uint32_t>(sensors::k_fiducial_count)[0],
                                 seen.field<std::int32_t>(sensors::k_fiducial_id).size());
  }
  /// The fiducial_return of the target: the number by which finders recognise it. 0 if the target is too far
  /// away to be recognised.
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
  /// straight ahead, the angle is unchanged.
  double turned(float angle) const {
    return finder_heading_ == 0 ? angle : wrap_angle(finder_heading_ + angle);
  }

  double finder_heading_ = 0;  // rad, in the frame of the drive
};

/// A body with a part that fiducial finders recognise by its fiducial_return.
struct MarkedBody {
  BodyId body;  ///< id of the body
  /// Origin of the part at the start of the run, m, world frame. If several parts have the fiducial_return,
  /// the origin of the first of them.
  Vec2 at;
};

/// The bodies that are in the world at the start of the run and have a part whose fiducial_return is `mark`,
/// in order of ids.
inline std::vector<MarkedBody> bodies_with_mark(const engine::WorldSpec& world, std::int32_t mark) {
  std::vector<MarkedBody> marked;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const BodyId id(b);
    const std::vector<engine::PartSpec>& parts = world.type(id).parts;
    std::uint32_t p = 0;
    while (p < parts.size() && engine::fiducial_of(world, id, p) != mark) ++p;
    if (p < parts.size() && world.starts(id))
      marked.push_back({id, compose(world.bodies[b].pose_world_body, parts[p].pose_body_part).position()});
  }
  return marked;
}

}  // namespace troupe::models
