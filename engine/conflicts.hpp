#pragma once

#include "partition/body_index.hpp"
#include "partition/overlap.hpp"
#include "partition/parallel.hpp"
#include "partition/static_scene.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// A motion that a body proposes for one tick.
struct Motion {
  Pose from;        ///< where it stands, world frame
  Pose to;          ///< where it would go
  double turn = 0;  ///< rad, from one to the other; not wrapped
  bool moves = false;
};

/// Poses at which a motion is tested: n = ceil(displacement / (thinnest part / 4)), equally spaced, the last
/// being `to` itself, and at most a million. The displacement is |translation| + radius * |turn|, which no
/// vertex exceeds: from one pose to the next a body moves less than its parts are thick, so nothing of any
/// thickness passes through it whole. Something thin may pass a corner of a part, by less than a quarter of
/// the part's width.
std::size_t motion_samples(const Motion& motion, const partition::ObstacleShape& shape);
Pose motion_pose(const Motion& motion, std::size_t k, std::size_t n);

/// Who may move this tick.
///
/// rule    In the order of priority, a body takes its proposed pose if the motion there is free of the static
///         scene and of every other body where that one is then: at its new pose if it went before and moved,
///         else at its old one. Otherwise it stays where it was. Priority is mix(seed, tick, id), ties by id.
///         Touching is free. A pair that overlaps at the mover's old pose never refuses a motion that takes
///         their origins apart, and a static solid that the body already overlaps does not refuse.
/// result  that of the sequential rule, body for body, on any number of threads
/// source  deterministic reservations: Blelloch, Fineman, Gibbons, Shun: Internally deterministic parallel
///         algorithms can be fast, PPoPP 2012. A body depends only on bodies of higher priority that its
///         motion may meet; nearly all have none and settle at once, the rest in a few rounds.
class Conflicts {
 public:
  /// One entry a row in each span.
  struct Crowd {
    std::span<const Motion> motions;
    std::span<const partition::ObstacleShape* const> shapes;
    std::span<const std::uint32_t> ids;  ///< ascending with the rows
    std::uint64_t seed = 1;
    std::uint64_t tick = 0;
    Box bounds;  ///< motions that end outside are refused
  };

  enum class Outcome : std::uint8_t { stands, moved, refused, held };  ///< held: at the bounds of the world

  /// The index holds every row at its motion's `from`.
  void settle(const Crowd& crowd, const partition::StaticScene& scene, const partition::BodyIndex& index,
              partition::Parallel& parallel, std::span<Outcome> outcomes);

  /// Rounds of the last settling: 1 where nobody had to wait.
  std::uint64_t rounds() const { return rounds_; }

 private:
  struct Waiting {
    std::uint32_t row;
    std::uint32_t first;  // into Work::others
    std::uint32_t count;
  };
  struct alignas(64) Work {  // of one batch, on cache lines of its own; kept between ticks so that a warm
                             // step allocates nothing
    std::vector<Waiting> waiting;
    std::vector<std::uint32_t> others;
    double longest = 0;              // squared, of the motions that are not far
    std::vector<std::uint32_t> far;  // rows whose motions are
  };

  std::vector<Work> work_;
  std::vector<std::uint32_t> far_;
  std::vector<std::uint64_t> priority_;
  std::vector<std::uint32_t> settled_;  // round * 4 + state, read and written atomically
  std::uint64_t rounds_ = 0;
};

}  // namespace troupe::engine
