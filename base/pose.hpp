#pragma once

#include "base/math.hpp"

#include <Eigen/Core>

namespace troupe {

/// A point or a displacement in the plane, metres unless it says otherwise; x forward or east, y left or
/// north.
using Vec2 = Eigen::Vector2d;

/// Position and heading in 2.5 dimensions: z is a height, rotation is about z only.
/// Metres and radians; +x forward, +y left, counter-clockwise positive. A variable of this type names both
/// frames: pose_world_body places the body's frame in the world's.
struct Pose {
  double x = 0;        ///< metres
  double y = 0;        ///< metres
  double z = 0;        ///< metres: the height of the frame's floor
  double heading = 0;  ///< radians from the x axis of the frame it is given in; not wrapped

  Vec2 position() const { return {x, y}; }  ///< without z
  friend bool operator==(const Pose&, const Pose&) = default;
};

/// A rotation kept as its sine and cosine, for use on many points.
struct Rotation {
  double cos = 1;  ///< of the heading
  double sin = 0;  ///< of the heading

  Rotation() = default;
  explicit Rotation(double heading) : Rotation(sincos(heading)) {}  ///< radians
  /// For callers who have it.
  explicit Rotation(const SinCos& heading) : cos(heading.cos), sin(heading.sin) {}
  /// A displacement in the rotated frame, in the frame that it is rotated in.
  Vec2 operator*(const Vec2& v) const { return {v.x() * cos - v.y() * sin, v.x() * sin + v.y() * cos}; }
};

/// A pose whose rotation is worked out, for use on many points.
struct Transform {
  /// Where the frame's origin lies, metres; the height is left to the caller.
  Vec2 position{0, 0};
  Rotation rotation;  ///< how it is turned

  Transform() = default;
  /// Z is dropped.
  explicit Transform(const Pose& pose) : position(pose.x, pose.y), rotation(pose.heading) {}
  Transform(const Vec2& p, const Rotation& r) : position(p), rotation(r) {}  ///< from its parts
  /// A point of the frame, in the frame that it is placed in.
  Vec2 operator*(const Vec2& point) const {
    const Vec2 turned = rotation * point;
    return {position.x() + turned.x(), position.y() + turned.y()};
  }
};

/// pose_a_c from pose_a_b and pose_b_c; the heading is wrapped into [-pi, pi].
/// transform_a_b: that of pose_a_b, for callers who have it.
inline Pose compose(const Pose& pose_a_b, const Transform& transform_a_b, const Pose& pose_b_c) {
  const Vec2 p = transform_a_b * pose_b_c.position();
  return {p.x(), p.y(), pose_a_b.z + pose_b_c.z, wrap_angle(pose_a_b.heading + pose_b_c.heading)};
}
/// The same for callers who have no transform: works it out.
inline Pose compose(const Pose& pose_a_b, const Pose& pose_b_c) {
  return compose(pose_a_b, Transform(pose_a_b), pose_b_c);
}

}  // namespace troupe
