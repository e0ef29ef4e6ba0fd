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

bool Collision::feels_as_mover() const { return sides_.feels_as_mover; }

BodyId Collision::other() const {
  const auto& [crowd, scene, mover, blocker, as_mover] = sides_;
  return as_mover ? crowd.blocks[mover].contact.blocker() : BodyId(crowd.ids[mover]);
}

bool Collision::reaches(const Vec2& a, const Vec2& b, double distance) const {
  const auto& [crowd, scene, row, blocker, as_mover] = sides_;
  const Conflicts::Block& block = crowd.blocks[row];
  const Mover mover(crowd, row);
  // Most segments that are reached at all are reached at the blocked sample.
  for (std::size_t k = block.sample; k > 0; --k) {
    const Pose pose = k < block.samples ? mover.between(k, block.samples) : mover.motion.to;
    const Transform at(pose);
    if (!as_mover) {
      const Transform& now = crowd.transforms[blocker];
      const ZInterval z = crowd.shapes[blocker]->z.shifted(block.z);
      if (is_near_segment(PlacedShape(mover.shape, at, pose.z), carried(a, now, block.at),
                          carried(b, now, block.at), distance, z))
        return true;
      continue;
    }
    const Vec2 there_a = carried(a, crowd.transforms[row], at);
    const Vec2 there_b = carried(b, crowd.transforms[row], at);
    const ZInterval z = mover.shape.z.shifted(pose.z);
    const bool is_near = Row(blocker).valid()
                             ? is_near_segment(PlacedShape(*crowd.shapes[blocker], block.at, block.z),
                                               there_a, there_b, distance, z)
                             : scene.is_near_segment(block.contact.blocker(), there_a, there_b, distance, z);
    if (is_near) return true;
  }
  return false;
}

}  // namespace troupe::engine
