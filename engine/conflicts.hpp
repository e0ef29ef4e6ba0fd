#pragma once

#include "partition/body_index.hpp"
#include "partition/overlap.hpp"
#include "partition/parallel.hpp"
#include "partition/static_scene.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace troupe::engine {

/// A motion that a body proposes for one tick. The rest means nothing where it does not move.
struct Motion {
  Pose to;             ///< where it would go, world frame
  Rotation rotation;   ///< of `to`
  double turn = 0;     ///< rad, from where it stands; not wrapped
  bool moves = false;  ///< false: it proposes to stay

  Transform there() const { return {to.position(), rotation}; }  ///< `to` as a transform, height left out
};

/// A circle that no edge of a static obstacle meets, m, world frame.
struct FreeCircle {
  float x = 0;       ///< centre
  float y = 0;       ///< centre
  float radius = 0;  ///< 0: nothing is known yet
};

/// The most bodies that one may push at once.
inline constexpr std::size_t k_most_pushed = 16;

/// Which rows can be pushed, and how many of them each row can push at once. One entry a row in both spans;
/// empty where nothing in the world can be pushed.
struct Pushables {
  std::span<const std::uint8_t> is_pushable;  ///< 1: the row can be pushed
  std::span<const std::uint8_t> limits;       ///< at most k_most_pushed
  double radius = 0;                          ///< of the largest that can be pushed, m
  double thinnest = 0;                        ///< of the parts of all that can be pushed, m
  std::size_t most = 0;                       ///< the limits taken together

  bool any() const { return !is_pushable.empty(); }  ///< whether anything in the world can be pushed
};

/// Who may move this tick, and what is pushed.
///
/// rule    In the order of priority, a body takes its proposed pose if the motion there is free of the static
///         scene and of every other body where that one is then: at its new pose if it went before and moved,
///         else at its old one. Otherwise it stays where it was. Priority is mix(seed, tick, id), ties by id.
///         Touching is free. A pair that overlaps at the mover's old pose never refuses a motion that takes
///         their origins apart, and a static solid that the body already overlaps does not refuse.
/// tested  at n = ceil(displacement / (thinnest part / 4)) poses, equally spaced, the last being `to` itself,
///         and at most a million. The displacement is |translation| + radius * |turn|, which no vertex
///         exceeds: from one pose to the next a body moves less than its parts are thick, so nothing of any
///         thickness passes through it whole. Something thin may pass a corner of a part, by less than a
///         quarter of the part's width.
/// pushed  What can be pushed does not refuse a body that can push, unless they overlap already where that
///         one stands: it gives way, or the whole motion is refused and nothing is moved. The body goes
///         through n = ceil(displacement / (thinnest part of it and of all that can be pushed / 4)) equally
///         spaced poses. At each of them it, and then each body that it pushes, in the order in which they
///         were first met, shifts whatever it overlaps, in the order of their ids, by partition::way_out and
///         k_rounding_m more: without a turn, and without going on by itself. Earlier ones push later ones,
///         never the other way round. That is repeated until nothing overlaps, at most k_push_passes
///         times. The motion is refused where it takes more bodies than the limit, or more passes; where one
///         of them would be shifted from one pose to the next by more than half of its thinnest part; and
///         where its new place is not within the bounds, not free of the static scene, or not free of every
///         body that is not pushed, each where it is then (but for what it overlapped before: as above).
///         Several may push one body in a tick, one after the other.
/// result  that of the sequential rule, body for body, on any number of threads
/// source  deterministic reservations: Blelloch, Fineman, Gibbons, Shun: Internally deterministic parallel
///         algorithms can be fast, PPoPP 2012. Of the bodies of higher priority that move too, a body depends
///         on those that would refuse it at one of their two poses and not at the other. Nearly all have none
///         and settle at once, the rest in a few rounds, which need no geometry any more. Who may come to
///         push has a circle that holds all that it could touch or move; it is looked at when all of higher
///         priority whose circles meet its own are settled.
/// memory  grows with the rows alone: settling allocates when there are more of them than ever before
class Conflicts {
 public:
  static constexpr int k_push_passes = 16;  ///< see `pushed`, above

  /// One entry a row in each span.
  struct Crowd {
    std::span<const Pose> poses;            ///< where they stand
    std::span<const Transform> transforms;  ///< of the poses
    std::span<const Motion> motions;        ///< what each proposes
    /// What of each blocks others, in its own frame; empty: nothing.
    std::span<const partition::ObstacleShape* const> shapes;
    std::span<const std::uint32_t> ids;  ///< no two alike
    /// What is known of the static scene around each: kept by the caller from tick to tick while the scene is
    /// the same, and changed here. It is no state: starting again with empty circles gives the same outcomes.
    std::span<FreeCircle> free;
    std::uint64_t seed = 1;    ///< of the world, for priorities
    std::uint64_t tick = 0;    ///< the one under way, for priorities
    Box bounds;                ///< motions that end outside are refused
    Pushables pushables = {};  ///< empty: no robot pushes
  };

  /// A row that was pushed, and where it is now; it has kept its height and heading.
  struct Push {
    std::uint32_t row;  ///< of the body
    Vec2 position;      ///< m, world frame
  };

  /// What became of a row's motion.
  enum class Outcome : std::uint8_t {
    stands,   ///< it proposed none
    moved,    ///< it is where it wanted to be
    refused,  ///< something is in the way: it stays where it was
    held,     ///< it would have left the world's bounds: it stays where it was
  };

  /// The index holds every row at its pose; rows that are not in it propose no motion.
  void settle(const Crowd& crowd, const partition::StaticScene& scene, const partition::BodyIndex& index,
              partition::Parallel& parallel);

  /// Overwrites with junk whatever the next settling must not read: no outcome may change by it. For tests.
  void forget();

  /// Of the last settling.
  Outcome outcome(std::size_t row) const {
    return settled_[row] / k_outcomes > base_ ? static_cast<Outcome>(settled_[row] % k_outcomes)
                                              : Outcome::stands;
  }
  /// Rounds of the last resolution: 1 where no body had to wait.
  std::uint64_t rounds() const { return rounds_; }
  /// No body's origin went farther in the last resolution, by itself or pushed, m.
  double longest() const { return longest_; }
  /// All pushes of the last settling, in any order; of one row perhaps several, of which one is_last.
  std::span<const Push> pushes() const { return {pushes_.data(), push_count_}; }
  /// Whether no later push moved the same row: its position is where the row ends. Only for elements of
  /// pushes().
  bool is_last(const Push& push) const { return pushed_last_[push.row] == &push - pushes_.data() + 1u; }

 private:
  class Settling;
  /// A row that waits for others, which are listed at [first, first + count) of others_.
  struct Waiting {
    std::uint32_t row;
    std::uint32_t first;
    std::uint32_t count;
  };
  enum class Zone : std::uint8_t { plain, pushes, may_push };  ///< may: if others push something there
  static constexpr std::uint32_t k_outcomes = 4;
  static constexpr std::size_t k_few_far = 64;

  void reserve(std::size_t rows, const Pushables& pushables);

  // round * k_outcomes + outcome, read and written atomically. Rounds are counted through all ticks, so that
  // what an earlier tick left needs no wiping: it is not above base_.
  std::vector<std::uint32_t> settled_;
  std::uint32_t base_ = 0;
  std::uint64_t rounds_ = 0;
  double longest_ = 0;

  // Lists that threads append to, in any order: no outcome depends on it. Not touched where no body waits.
  std::size_t reserved_ = 0;
  std::unique_ptr<Waiting[]> waiting_;
  std::unique_ptr<Waiting[]> still_waiting_;
  std::unique_ptr<std::uint32_t[]> others_;  // 2 * row, + 1 where it refuses once it has moved
  std::array<std::uint32_t, k_few_far> far_;

  // Only where something can be pushed. Each push is written once and never changed, so that who reads a
  // place that another thread replaces finds the old or the new one whole.
  /// What a row pushed: [first, first + count) of pushes_.
  struct PushesOf {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::vector<Zone> zones_;
  std::vector<PushesOf> pushes_of_;
  std::vector<Push> pushes_;
  std::size_t push_count_ = 0;
  std::vector<std::uint32_t>
      pushed_last_;  // of a row, its last push, from 1; 0: none. Read and written atomically
};

}  // namespace troupe::engine
