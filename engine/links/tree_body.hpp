#pragma once

#include "engine/kinds/mount.hpp"
#include "engine/links/links.hpp"

#include <cstddef>
#include <cstdint>

// Parts of Links that several of its source files use.

namespace troupe::engine {

/// A body of a tree. A tree consists of a root, which is a body that is not carried, and of all bodies that
/// the root carries, directly or through others. Functions visit a tree from its root.
struct Links::TreeBody {
  Row row;
  Mount place;         // the body's frame, relative to the root's frame
  bool moves = false;  // whether a joint between it and the root moves in this round of resolution
};

inline constexpr std::size_t k_trees_per_task = 64;
inline constexpr std::size_t k_near_capacity = 64;  ///< initial, of the lists of trees near one tree

/// Returns the map of the points that a joint moves, in the frame of the body: from their positions with all
/// joints at rest to their positions with this joint displaced by `q` (m, rad). `parent` is this map for the
/// parent joint, or the identity if the joint has no parent.
inline Mount moved_by(const BodyType::Joint& joint, const Mount& parent, const Pose& q) {
  if (q == Pose{}) return parent;
  return compose(compose(compose(parent, joint.at_rest), Mount(q)), joint.to_body);
}

template <class Work>
void Links::for_roots(Work&& work) {
  parallel_.for_batches(composites_.size(), k_trees_per_task, [&](std::size_t first, std::size_t end) {
    for (std::size_t c = first; c < end; ++c)
      if (const std::uint32_t r = composites_[c]; state_.roots[r] == r) work(c, r);
  });
}

}  // namespace troupe::engine
