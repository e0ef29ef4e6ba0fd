#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"

namespace troupe::engine {

/// A motion that a body blocked in this tick (time step), as a device (DeviceKind::collide) on one of the two
/// bodies feels it. The *mover* is the body whose motion was blocked; it stays where it was. The mover and
/// the body that blocks it first (Contact::body) are the two sides. Use it only in the hook `collide`.
class Collision {
 public:
  struct Sides;  // engine/conflicts/collision.hpp
  /// `sides` must outlive the object.
  explicit Collision(const Sides& sides) : sides_(sides) {}

  bool feels_as_mover() const;  ///< whether the device is on the mover
  /// The body on the other side. Of a tree (bodies that carry one another), it is the root.
  BodyId other() const;
  /// Whether the motion up to its earliest blocked sample, which overlaps the other body, would have brought
  /// a segment that is fixed to the device's body within `distance` of the other body, seen from above. Only
  /// those parts of the other body count whose heights overlap those of the device's body.
  ///
  /// a, b: ends of the segment with the bodies where they were before the motions of this tick (where
  /// DeviceBatch::mount() has them), m, world frame
  bool reaches(const Vec2& a, const Vec2& b, double distance) const;

 private:
  const Sides& sides_;
};

}  // namespace troupe::engine
