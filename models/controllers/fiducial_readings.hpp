#pragma once

#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/kinds/controller_kind.hpp"
#include "engine/spec/world_spec.hpp"
#include "sensors/fiducial.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::models {

/// Gives a controller access to the readings of a fiducial finder, a sensor that detects marked objects. A
/// target is an object that the finder has detected: a body or a part of a body. Angles are in the frame of
/// the drive.
///
/// Arguments of the functions:
/// seen: the readings of the finder
/// target: index of a target, from 0 to count() - 1. The targets are sorted by distance, the nearest first
class FiducialReadings {
 public:
  FiducialReadings() = default;
  /// finder: a fiducial finder (a device of the kind `fiducial`) that the controller uses.
  explicit FiducialReadings(const engine::DeviceInfo& finder) : finder_heading_(finder.pose.heading) {}

  /// Number of targets in the readings. If the finder detects more targets than the readings have room for,
  /// the readings hold only the nearest targets.
  std::size_t count(const engine::Readings& seen) const {
    return std::min<std::size_t>(seen.field<std::uint32_t>(sensors::k_fiducial_count)[0],
                                 seen.field<std::int32_t>(sensors::k_fiducial_id).size());
  }
  /// The number by which finders recognise the target: its fiducial_return in the world file. 0 if the target
  /// is too far away to be recognised.
  std::int32_t id(const engine::Readings& seen, std::size_t target) const {
    return seen.field<std::int32_t>(sensors::k_fiducial_id)[target];
  }
  /// Horizontal distance from the finder to the origin of the target, m.
  float range(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(sensors::k_fiducial_range)[target];
  }
  /// Angle from straight ahead of the drive to the direction from the finder to the origin of the target,
  /// rad, counter-clockwise.
  double bearing(const engine::Readings& seen, std::size_t target) const {
    return turned(seen.field<float>(sensors::k_fiducial_bearing)[target]);
  }
  /// Angle from straight ahead of the drive to the heading of the target, rad, counter-clockwise.
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

/// A body with a certain mark. The mark (fiducial_return) is a number by which fiducial finders, which are
/// sensors, recognise a part of a body. A world file gives it.
struct MarkedBody {
  BodyId body;  ///< id of the body
  /// Origin of the part with the mark at the start of the run, m, world frame. If several parts have the
  /// mark: the one that comes first in TypeSpec::parts.
  Vec2 at;
};

/// Returns the bodies that have a part with the mark `mark` and are in the world at the start of the run, in
/// the order of their ids.
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
