#include "engine/conflicts/collision.hpp"

#include "engine/conflicts/conflict_resolver.hpp"

namespace troupe::engine {
namespace {

/// Where a point that is fixed to a body is after the body has gone from `from` to `to`.
Vec2 carried(const Vec2& point, const Transform& from, const Transform& to) {
  const Vec2 way = point - from.position;
  const Rotation& r = from.rotation;
  return to * Vec2(r.cos * way.x() + r.sin * way.y(), r.cos * way.y() - r.sin * way.x());
}

}  // namespace

BodyId Collision::other() const {
  return feels_as_mover_ ? crowd_.blocks[mover_].contact.blocker() : BodyId(crowd_.ids[mover_]);
}

bool Collision::reaches(const Vec2& a, const Vec2& b, double distance) const {
  const Conflicts::Block& block = crowd_.blocks[mover_];
  const Mover mover(crowd_, mover_);
  const bool is_static = !Row(blocker_).valid();
  // Most segments that are reached at all are reached at the blocked sample.
  for (std::size_t k = block.sample; k > 0; --k) {
    const Pose pose = k < block.samples ? mover.between(k, block.samples) : mover.motion.to;
    const Transform at(pose);
    if (!feels_as_mover_) {
      const Transform& now = crowd_.transforms[blocker_];
      const ZInterval z = crowd_.shapes[blocker_]->z.shifted(block.z);
      if (is_near_segment(PlacedShape(mover.shape, at, pose.z), carried(a, now, block.at),
                          carried(b, now, block.at), distance, z))
        return true;
      continue;
    }
    const Vec2 there_a = carried(a, crowd_.transforms[mover_], at);
    const Vec2 there_b = carried(b, crowd_.transforms[mover_], at);
    const ZInterval z = mover.shape.z.shifted(pose.z);
    const bool is_near = is_static
                             ? scene_.is_near_segment(block.contact.blocker(), there_a, there_b, distance, z)
                             : is_near_segment(PlacedShape(*crowd_.shapes[blocker_], block.at, block.z),
                                               there_a, there_b, distance, z);
    if (is_near) return true;
  }
  return false;
}

}  // namespace troupe::engine
