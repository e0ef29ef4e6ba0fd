#pragma once

#include "base/math.hpp"

#include <Eigen/Core>

namespace troupe {

/// A point or a displacement in the plane, in metres unless stated otherwise. In the frame of a body, x
/// points forward and y to the left. In the world frame, x points east and y north.
using Vec2 = Eigen::Vector2d;

/// A position and a heading: the pose of one frame in another, its parent frame. z is a height, and rotation
/// is about z only. Metres and radians; +x forward, +y left, counter-clockwise positive. The name of a
/// variable of this type names both frames: pose_world_body is the pose of the body frame in the world frame.
struct Pose {
  double x = 0;        ///< position along x, metres
  double y = 0;        ///< position along y, metres
  double z = 0;        ///< height above the origin of the parent frame, metres
  double heading = 0;  ///< radians from the x axis of the parent frame; may be outside [-pi, pi]

  Vec2 position() const { return {x, y}; }  ///< x and y in metres, without z
  friend bool operator==(const Pose&, const Pose&) = default;
};

/// The value that stands for a missing pose, such as that of a body that is not in the world: four NaNs.
inline constexpr Pose k_nowhere{k_nan, k_nan, k_nan, k_nan};

/// A rotation of a frame in its parent frame, stored as the sine and cosine of the heading. It is for
/// transforming many displacements.
struct Rotation {
  double cos = 1;  ///< cosine of the heading
  double sin = 0;  ///< sine of the heading

  Rotation() = default;
  explicit Rotation(double heading) : Rotation(sincos(heading)) {}  ///< the rotation by a heading in radians
  /// Creates the rotation by a heading whose sine and cosine are given.
  explicit Rotation(const SinCos& heading) : cos(heading.cos), sin(heading.sin) {}
  /// Transforms a displacement, given in the rotated frame, to the parent frame.
  Vec2 operator*(const Vec2& v) const { return {v.x() * cos - v.y() * sin, v.x() * sin + v.y() * cos}; }
};

/// The pose of a frame in its parent frame, without height, with the sine and cosine of its heading. It is
/// for transforming many points.
struct Transform {
  /// The origin of the frame, in the parent frame, metres.
  Vec2 position{0, 0};
  Rotation rotation;  ///< the rotation of the frame in the parent frame

  Transform() = default;
  /// Creates the transform of a pose. The z of the pose is ignored.
  explicit Transform(const Pose& pose) : position(pose.x, pose.y), rotation(pose.heading) {}
  Transform(const Vec2& p, const Rotation& r)
      : position(p), rotation(r) {}  ///< the transform with this position and rotation
  /// Transforms a point, given in the frame, to the parent frame.
  Vec2 operator*(const Vec2& point) const {
    const Vec2 turned = rotation * point;
    return {position.x() + turned.x(), position.y() + turned.y()};
  }
};

/// Combines two poses: returns pose_a_c from pose_a_b and pose_b_c. The heading is wrapped into [-pi, pi].
/// transform_a_b must equal Transform(pose_a_b). A caller that combines the same pose_a_b with many poses
/// needs to compute the transform only once.
inline Pose compose(const Pose& pose_a_b, const Transform& transform_a_b, const Pose& pose_b_c) {
  const Vec2 p = transform_a_b * pose_b_c.position();
  return {p.x(), p.y(), pose_a_b.z + pose_b_c.z, wrap_angle(pose_a_b.heading + pose_b_c.heading)};
}
/// Combines two poses: returns pose_a_c from pose_a_b and pose_b_c. The heading is wrapped into [-pi, pi].
inline Pose compose(const Pose& pose_a_b, const Pose& pose_b_c) {
  return compose(pose_a_b, Transform(pose_a_b), pose_b_c);
}

/// Returns the bearing of the point `to`, seen from the pose `from`: the angle from the heading of the pose
/// to the direction of the point, rad, in [-pi, pi], positive to the left. The point and the pose must be
/// given in the same frame. If the point is at the position of the pose, the result is minus the heading,
/// wrapped into [-pi, pi].
inline double bearing_of(const Pose& from, const Vec2& to) {
  return wrap_angle(atan2(to.y() - from.y, to.x() - from.x) - from.heading);
}

}  // namespace troupe
