#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "partition/static_scene.hpp"

#include <cstdint>

namespace troupe::engine {

/// A motion that a body blocked in this tick (time step), as a device (DeviceKind::collide) on one of the two
/// bodies feels it. The *mover* is the body whose motion was blocked; it stays where it was. The mover and
/// the body that blocks it first (Contact::body) are the two sides.
class Collision {
 public:
  /// Of a motion with a sample in Crowd::blocks. The arguments must outlive the object.
  ///
  /// mover: row of the mover
  /// blocker: row of the body that blocked it; the value of a Row that is not valid() if that is static
  /// feels_as_mover: whether the device is on the mover, or on the body in its way
  Collision(const Conflicts::Crowd& crowd, const partition::StaticScene& scene, std::uint32_t mover,
            std::uint32_t blocker, bool feels_as_mover)
      : crowd_(crowd), scene_(scene), mover_(mover), blocker_(blocker), feels_as_mover_(feels_as_mover) {}

  bool feels_as_mover() const { return feels_as_mover_; }  ///< whether the device is on the mover
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
  const Conflicts::Crowd& crowd_;
  const partition::StaticScene& scene_;
  std::uint32_t mover_;
  std::uint32_t blocker_;  // row; the value of an invalid Row if it is static
  bool feels_as_mover_;
};

}  // namespace troupe::engine
