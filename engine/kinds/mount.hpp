#pragma once

#include "base/pose.hpp"

namespace troupe::engine {

/// A frame relative to another frame. Unlike a Pose, a Mount contains the sine and cosine of the heading, so
/// that chains of frames are cheap to compute.
struct Mount {
  Transform transform;  ///< position, m, and rotation in the plane
  double z = 0;         ///< height of the frame's origin in the other frame, m
  double heading = 0;   ///< angle of the rotation, rad; not wrapped

  Mount() = default;  ///< the identity
  Mount(const Transform& at, double height, double turned)
      : transform(at), z(height), heading(turned) {}  ///< height in m; `turned`: heading of `at`, rad
  /// The frame at a pose.
  explicit Mount(const Pose& pose) : Mount(Transform(pose), pose.z, pose.heading) {}

  /// The frame as a pose, with the heading wrapped into [-pi, pi]. No member of the result is -0, so poses
  /// that compare equal have equal bits.
  Pose pose() const {
    return {transform.position.x() + 0.0, transform.position.y() + 0.0, z + 0.0, wrap_angle(heading) + 0.0};
  }
};

/// Whether a frame is the identity: its origin and its axes are those of the other frame.
inline bool is_identity(const Mount& mount) {
  return mount.transform.position == Vec2::Zero() && mount.z == 0 && mount.heading == 0;
}

/// Combines two frames: `a` is the frame B relative to a frame A, `b` is a frame C relative to B, and the
/// result is C relative to A. The heading is not wrapped. If one argument is the identity, the result equals
/// the other argument bit for bit, except that -0 may become 0.
inline Mount compose(const Mount& a, const Mount& b) {
  const Rotation& r = a.transform.rotation;
  const Rotation& s = b.transform.rotation;
  Rotation both;
  both.cos = r.cos * s.cos - r.sin * s.sin;
  both.sin = r.sin * s.cos + r.cos * s.sin;
  return {Transform(a.transform * b.transform.position, both), a.z + b.z, a.heading + b.heading};
}

/// Combines a frame with a pose: `a` is the frame B relative to a frame A, `b` is a pose in B, and the result
/// is the same pose in A. The heading is wrapped into [-pi, pi]. For `a` = Mount(pose), the result has the
/// same bits as compose(pose, Transform(pose), b) in base/pose.hpp.
inline Pose compose(const Mount& a, const Pose& b) {
  const Vec2 p = a.transform * b.position();
  return {p.x(), p.y(), a.z + b.z, wrap_angle(a.heading + b.heading)};
}

/// Returns the inverse: if `mount` is a frame B relative to a frame A, the result is A relative to B.
inline Mount inverse(const Mount& mount) {
  Rotation back;
  back.cos = mount.transform.rotation.cos;
  back.sin = -mount.transform.rotation.sin;
  const Vec2 turned = back * mount.transform.position;
  return {Transform(Vec2(-turned.x(), -turned.y()), back), -mount.z, -mount.heading};
}

}  // namespace troupe::engine
