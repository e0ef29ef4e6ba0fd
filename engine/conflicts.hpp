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

/// A motion that a body proposes for one tick. The other members are meaningless if `moves` is false.
struct Motion {
  Pose to;             ///< proposed pose, world frame
  Rotation rotation;   ///< of `to`
  double turn = 0;     ///< rad, relative to the old heading; not wrapped
  bool moves = false;  ///< false: the body proposes to stay

  Transform there() const { return {to.position(), rotation}; }  ///< `to` as a transform, without the height
};

/// A circle that no edge of a static obstacle crosses, m, world frame.
struct FreeCircle {
  float x = 0;       ///< centre
  float y = 0;       ///< centre
  float radius = 0;  ///< 0: not yet known
};

/// The largest number of bodies that a body may push at once.
inline constexpr std::size_t k_most_pushed = 16;

/// Which rows can be pushed, and how many bodies each row can push at once. One entry per row in both spans;
/// both are empty if the world has no pushable bodies.
struct Pushables {
  std::span<const std::uint8_t> is_pushable;  ///< 1: the row can be pushed
  std::span<const std::uint8_t> limits;       ///< at most k_most_pushed
  double radius = 0;                          ///< of the largest pushable body, m
  double thinnest = 0;                        ///< part of all pushable bodies, m
  std::size_t most = 0;                       ///< sum of `limits`

  bool any() const { return !is_pushable.empty(); }  ///< whether the world has pushable bodies
};

/// Decides which bodies move in a tick, and which bodies they push.
///
/// rule    Bodies take turns in the order of priority. A body takes its proposed pose if the motion there is
///         free of the static scene and of every other body. A body that had its turn and moved is tested at
///         its new pose, any other at its old pose. If the motion is blocked, the body stays at its old pose.
///         Priority is mix(seed, tick, id), the lowest first, ties by id. Touching is free. A body that
///         overlaps the mover at the mover's old pose never blocks a motion that increases the distance
///         between their origins. A static solid that the mover already overlaps never blocks it.
/// samples A motion is tested at n = ceil(displacement / (thinnest part / 4)) equally spaced poses, the last
///         being `to` itself, and at most a million. The displacement is |translation| + radius * |turn|,
///         which no vertex exceeds. Between two consecutive poses a body moves less than the thickness of its
///         parts, so no body of any thickness passes through it whole. A thin body may pass a corner of a
///         part, by less than a quarter of the part's width.
/// pushing A pushable body does not block a body that can push, unless the two overlap at the pusher's old
///         pose. Either it gives way, or the whole motion is blocked and no body moves. The pusher goes
///         through n = ceil(displacement / (thinnest part of it and of all pushable bodies / 4)) equally
///         spaced poses. At each pose the pusher, and then each body that it pushes, in the order in which
///         they were first met, shifts every body that it overlaps, in the order of their ids, by
///         partition::way_out plus k_rounding_m. Pushed bodies do not turn and do not keep moving. Earlier
///         bodies push later ones, never the reverse. This is repeated until no bodies overlap, at most
///         k_push_passes times. The motion is blocked if it needs more bodies than the limit, or more passes;
///         if a pushed body would be shifted by more than half of its thinnest part between two poses; or if
///         its new position is out of bounds, not free of the static scene, or not free of every body that is
///         not pushed, each at its pose of that turn (except for overlaps from before, as above). Several
///         bodies may push the same body in a tick, one after another.
/// result  The outcome of each body is that of the sequential rule, on any number of threads.
/// source  Deterministic reservations: Blelloch, Fineman, Gibbons, Shun: Internally deterministic parallel
///         algorithms can be fast, PPoPP 2012. Among the moving bodies of higher priority, a body depends on
///         those that would block it at exactly one of their two poses. Nearly all bodies depend on none and
///         are resolved at once; the rest are resolved in a all_listed rounds that need no geometry, unless a
///         body has very many dependencies. A body that may come to push has a zone: a circle that holds all
///         that it could touch or move. It is resolved after all bodies of higher priority whose zones
///         overlap its own.
/// memory  Grows with the number of rows. resolve() allocates only when there are more rows than ever before,
///         or when a pusher has more than 512 bodies in its zone.
class Conflicts {
 public:
  static constexpr int k_push_passes = 16;  ///< see `pushing`, above

  /// The bodies of a tick: one entry per row in each span.
  struct Crowd {
    std::span<const Pose> poses;            ///< old poses, world frame
    std::span<const Transform> transforms;  ///< of `poses`
    std::span<const Motion> motions;        ///< proposed motions
    /// Obstacle shapes, body frame. A body with an empty shape blocks no other and is never blocked.
    std::span<const partition::ObstacleShape* const> shapes;
    std::span<const std::uint32_t> ids;  ///< unique
    /// A cache: a circle about each row that is free of the static scene. The caller keeps it from tick to
    /// tick as long as the scene is the same; resolve() updates it. It is not state: starting again with
    /// empty circles gives the same outcomes.
    std::span<FreeCircle> free;
    std::uint64_t seed = 1;    ///< of the world, for priorities
    std::uint64_t tick = 0;    ///< the current tick, for priorities
    Box bounds;                ///< m, world frame; a motion that ends outside is out of bounds
    Pushables pushables = {};  ///< empty: no robot pushes
  };

  /// A pushed row and its new position. Its height and heading do not change.
  struct Push {
    std::uint32_t row;  ///< of the pushed body
    Vec2 position;      ///< m, world frame
  };

  /// The outcome of a row's motion.
  enum class Outcome : std::uint8_t {
    stands,         ///< it proposed no motion
    moved,          ///< it is at its proposed pose
    blocked,        ///< it stays at its old pose, because a body or a static solid is in its way
    out_of_bounds,  ///< it stays at its old pose, because the motion ends outside the bounds of the world
  };

  /// Resolves all motions of a tick. The index holds every row at its pose; rows that are not in it must
  /// propose no motion.
  void resolve(const Crowd& crowd, const partition::StaticScene& scene, const partition::BodyIndex& index,
               partition::Parallel& parallel);

  /// Overwrites with junk all data that the next resolution must not read, so that tests can show that no
  /// outcome depends on it.
  void forget();

  /// Outcome of a row in the last resolution.
  Outcome outcome(std::size_t row) const {
    return resolutions_[row].round() > base_ ? resolutions_[row].outcome() : Outcome::stands;
  }
  /// Rounds of the last resolution; 1 if no body had to wait.
  std::uint64_t rounds() const { return rounds_; }
  /// Upper bound, m, on how far any body's origin moved in the last resolution, driven or pushed.
  double longest() const { return longest_; }
  /// All pushes of the last resolution, in any order. A row may have several, exactly one of which is_last.
  std::span<const Push> pushes() const { return {pushes_.data(), push_count_}; }
  /// Whether this is the last push of its row, so that its position is final. Only for elements of pushes().
  bool is_last(const Push& push) const { return pushed_last_[push.row] == &push - pushes_.data() + 1u; }

 private:
  class Resolver;
  /// An outcome and the round that found it, in one word that is read and written atomically.
  class Resolution {
   public:
    Resolution() = default;  ///< of round 0, which does not exist
    Resolution(std::uint32_t round, Outcome outcome)
        : word_(round * k_outcomes + static_cast<std::uint32_t>(outcome)) {}
    std::uint32_t round() const { return word_ / k_outcomes; }
    Outcome outcome() const { return static_cast<Outcome>(word_ % k_outcomes); }

   private:
    static constexpr std::uint32_t k_outcomes = 4;
    std::uint32_t word_ = 0;
  };
  /// A row on which the outcome of another row depends, in one word.
  class Dependency {
   public:
    Dependency() = default;  ///< not initialised
    /// if_moved: the row blocks the other if it has moved; false: if it has not
    Dependency(std::uint32_t row, bool if_moved) : word_(2 * row + (if_moved ? 1 : 0)) {}
    std::uint32_t row() const { return word_ / 2; }
    bool if_moved() const { return word_ % 2 != 0; }

   private:
    std::uint32_t word_;
  };
  /// A row that waits for other rows, which are listed at [first, first + count) of others_.
  struct Waiting {
    std::uint32_t row;
    std::uint32_t first;
    std::uint32_t count;
  };
  /// Whether pushable bodies are in a mover's zone: none, some, or none unless another body pushes some in.
  enum class Zone : std::uint8_t { plain, pushes, may_push };
  static constexpr std::size_t k_max_far = 64;

  void reserve(std::size_t rows, const Pushables& pushables);

  // One per row. The count of rounds continues from tick to tick, so entries of earlier ticks need not be
  // cleared: their rounds do not exceed base_.
  std::vector<Resolution> resolutions_;
  std::uint32_t base_ = 0;
  std::uint64_t rounds_ = 0;
  double longest_ = 0;

  // Lists that threads append to, in any order: no outcome depends on it. Unused if no body waits.
  std::size_t reserved_ = 0;
  std::unique_ptr<Waiting[]> waiting_;
  std::unique_ptr<Waiting[]> still_waiting_;
  std::unique_ptr<Dependency[]> others_;
  std::array<std::uint32_t, k_max_far> far_;

  // Only used if bodies can be pushed. Each push is written once and never changed, so a thread that reads a
  // position while another thread replaces it finds either the old or the new one, complete.
  /// The pushes of a row: [first, first + count) of pushes_.
  struct PushesOf {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::vector<Zone> zones_;
  std::vector<PushesOf> pushes_of_;
  std::vector<Push> pushes_;
  std::size_t push_count_ = 0;
  std::vector<std::uint32_t>
      pushed_last_;  // last push of each row, counted from 1; 0: none. Read and written atomically
};

}  // namespace troupe::engine
