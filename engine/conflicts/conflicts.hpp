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

/// The motion that a body proposes for one tick (time step). If `moves` is false, the other members have no
/// meaning.
struct Motion {
  Pose to;             ///< proposed pose, world frame
  Rotation rotation;   ///< rotation by the heading of `to`; must be set in addition to `to`
  double turn = 0;     ///< change of the heading, counter-clockwise, rad; not wrapped
  bool moves = false;  ///< false: the body proposes no motion

  Transform there() const { return {to.position(), rotation}; }  ///< `to` as a transform, without the height
};

/// A circle in the plane into which no edge of a static obstacle reaches, at any height; m, world frame.
struct FreeCircle {
  float x = 0;       ///< x of its centre
  float y = 0;       ///< y of its centre
  float radius = 0;  ///< its radius; 0: no circle is known yet
};

/// The largest number of bodies that one body may push in a tick.
inline constexpr std::size_t k_most_pushed = 16;

/// Which bodies can be pushed, and how many bodies each body can push in a tick. A row is the index of a body
/// in the state tables. Both spans have one entry per row, or are empty if the world has no pushable bodies;
/// the other members then have no meaning.
struct Pushables {
  std::span<const std::uint8_t> is_pushable;  ///< 1 if the row can be pushed, otherwise 0
  std::span<const std::uint8_t> limits;       ///< number of bodies that the row can push, 0 to k_most_pushed
  double radius = 0;                          ///< radius of the largest pushable body about its origin, m
  double thinnest = 0;                        ///< width of the thinnest part of all pushable bodies, m
  std::size_t most = 0;                       ///< sum of `limits` over all rows

  bool any() const { return !is_pushable.empty(); }  ///< whether the world has pushable bodies
};

/// Decides which bodies move in a tick, and which bodies they push. The static scene is the geometry of the
/// bodies that do not move during a run; it consists of solids, which are extruded polygons. Parts of two
/// bodies can only overlap if they have heights in common.
///
/// rule    Bodies take turns in the order of priority. The body whose turn it is (the mover) takes its
///         proposed pose if its motion to that pose is free of the static scene and of every other body. The
///         other bodies are tested at their new poses if they have had their turn and moved, and otherwise at
///         their old poses. If the motion is blocked, the mover stays at its old pose. The priority is a
///         hash, mix(seed, tick, id): the body with the lowest hash has the first turn, and ties are broken
///         by id. Bodies that only touch do not block each other. A body that overlaps the mover at the
///         mover's old pose never blocks a motion that increases the distance between their origins. A solid
///         of the static scene that the mover already overlaps does not block the motion, unless that overlap
///         may be due to rounding (StaticScene::blocks()).
/// samples A motion is tested at n = ceil(displacement / (width of the mover's thinnest part / 4)) equally
///         spaced poses, but not at more than a million. The last pose is Motion::to. The displacement is an
///         upper bound on the motion of any vertex: |translation| + radius * |turn|. Between two consecutive
///         poses a body moves less than the thickness of its parts, so no other body, however thin, passes
///         through it completely. A thin body may pass through a corner of a part, at a depth of less than a
///         quarter of the part's width.
/// pushing A body that can push (a pusher) pushes only if a pushable body was in its zone (see `source`)
///         before the tick. A pushable body does not block a pusher, unless the two overlap at the pusher's
///         old pose. Either the pushable body gives way, or the whole motion is blocked and no body
///         moves. The pusher goes through n = ceil(displacement / (width of the thinnest part of the pusher
///         and of all pushable bodies / 4)) equally spaced poses. At each of them it makes passes, until no
///         bodies overlap, but at most k_push_passes. A pass goes through the pusher and the bodies that it
///         pushes, in the order in which they were first met. Each of them shifts every body that it
///         overlaps, in the order of the ids of those bodies, by the shortest displacement that separates the
///         two (partition::way_out()) plus k_rounding_m. Pushed bodies do not turn and do not keep moving.
///         Bodies that were met earlier push bodies that were met later, never the reverse. The motion is
///         blocked in each of these cases: it needs to push more bodies than the limit; it needs more than
///         k_push_passes passes at a pose; a pushed body would be shifted by more than half of its thinnest
///         part between two poses; the new position of a pushed body is out of bounds, or not free of the
///         static scene, or not free of every body that is not pushed. The bodies that are not pushed are
///         tested at the poses that they have when it is the pusher's turn, and overlaps that existed before
///         do not count, as in `rule`. Several bodies may push the same body in a tick, one after another.
/// result  The outcome of each body is that of this sequential rule, on any number of threads.
/// source  Deterministic reservations: Blelloch, Fineman, Gibbons, Shun: Internally deterministic parallel
///         algorithms can be fast, PPoPP 2012. A body depends on those moving bodies of higher priority that
///         would block it at only one of their two poses, the old or the new one. Nearly all bodies depend on
///         no other body and are resolved at once. The remaining bodies are resolved in rounds that need no
///         geometric tests, except for bodies with very many dependencies. A body that may push has a zone: a
///         circle that contains everything that it could touch or move. It is resolved after all bodies of
///         higher priority whose zones overlap its zone.
/// memory  Grows with the number of rows. resolve() allocates only in these cases: the number of rows has
///         become larger than the memory, or less than about two thirds of it (base/room.hpp); the sum of
///         push limits (Pushables::limits) is larger than ever before; a pusher has more than 512 bodies in
///         its zone.
class Conflicts {
 public:
  static constexpr int k_push_passes = 16;  ///< largest number of passes: see `pushing`, above

  /// The bodies whose motions are resolved in a tick. All spans have one entry per row, except those of
  /// `pushables`, which may be empty.
  struct Crowd {
    std::span<const Pose> poses;            ///< old poses, world frame
    std::span<const Transform> transforms;  ///< the old poses as transforms, bit for bit Transform(pose)
    std::span<const Motion> motions;        ///< proposed motions
    /// Obstacle shapes, body frame. A body with an empty shape blocks no other and is never blocked.
    std::span<const partition::ObstacleShape* const> shapes;
    std::span<const std::uint32_t> ids;  ///< ids of the bodies; no two are equal
    /// A cache: for each row, a circle near its body into which the static scene does not reach. resolve()
    /// updates the circles. The caller keeps them from tick to tick, and resets them to FreeCircle() when the
    /// static scene changes. They are not state: circles with radius 0 give the same outcomes.
    std::span<FreeCircle> free;
    std::uint64_t seed = 1;    ///< seed of the world, for priorities
    std::uint64_t tick = 0;    ///< the current tick, for priorities
    Box bounds;                ///< box in which motions must end, m, world frame
    Pushables pushables = {};  ///< which bodies can push or be pushed; empty: none
  };

  /// A push of a body: its row and its new position. The height and heading of the body do not change.
  struct Push {
    std::uint32_t row;  ///< row of the pushed body
    Vec2 position;      ///< new position of its origin, m, world frame
  };

  /// The outcome of a row's motion.
  enum class Outcome : std::uint8_t {
    stands,         ///< the body proposed no motion; it may have been pushed (pushes())
    moved,          ///< the body is at its proposed pose
    blocked,        ///< the body stays at its old pose, because another body is in its way, mobile or static
    out_of_bounds,  ///< the body stays at its old pose, because the motion would end outside Crowd::bounds
  };

  /// The connection to the other ranks, if several ranks (threads or processes that compute a world together)
  /// resolve the motions of one tick. Each rank resolves its own rows, and has a copy (a *ghost*) of each row
  /// of another rank that could block or be blocked by one of its own.
  class Border {
   public:
    virtual ~Border() = default;
    /// Called first. Returns those rows of `order` that this rank resolves; all other rows are ghosts.
    ///
    /// motions: the proposed motions, one per row
    /// order: all rows in the spatial index
    virtual std::span<const std::uint32_t> begin(std::span<const Motion> motions,
                                                 std::span<const std::uint32_t> order) = 0;
    /// Called each time when this rank can resolve no further row until it knows more outcomes of ghosts, and
    /// finally when it has resolved all its rows. Sends outcome() and pushes_by() of the own rows to the
    /// ranks that have ghosts of them. Passes the outcomes and pushes of ghosts that it receives to
    /// receive(). Pushes of the same body must be received in the order of the rounds (round_of()) in which
    /// they were made. Returns false if the outcomes of all ghosts are known and those of all own rows were
    /// sent.
    virtual bool exchange(Conflicts& conflicts) = 0;
    /// Called last. If the last push of a body was made by a row of this rank, sends the final position of
    /// the body to all other ranks. Passes the final positions that it receives to receive_place(), for
    /// bodies that have a row here. This is needed because this rank may have no ghost of the body that made
    /// the last push.
    virtual void exchange_places(Conflicts& conflicts) = 0;
  };

  /// Resolves all motions of a tick, on the threads of `parallel`. The index must contain the rows with their
  /// old poses. Rows that it does not contain, such as those of dead bodies, must propose no motion; they do
  /// not block other bodies. This function does not change the poses in `crowd`: the caller does so
  /// afterwards, according to outcome() and pushes().
  ///
  /// border: the connection to the other ranks, if `crowd` has ghosts
  void resolve(const Crowd& crowd, const partition::StaticScene& scene, const partition::BodyIndex& index,
               partition::Parallel& parallel, Border* border = nullptr);
  /// Stores the outcome of the motion of a ghost. `pushes` are the pushes that the ghost made of bodies that
  /// have a row here. Border::exchange() calls this for each outcome that it receives.
  void receive(std::uint32_t row, Outcome outcome, std::span<const Push> pushes);
  /// Stores the final position of a pushed body. Border::exchange_places() calls this.
  void receive_place(const Push& push);

  /// Overwrites all data of earlier ticks with junk. Tests call this to show that no outcome of the next
  /// resolution depends on these data. Afterwards, and until the next resolution, outcomes and longest() have
  /// no meaning, and there are no pushes.
  void forget();

  /// Outcome of a row in the last resolution. The row must have been one of the rows of that resolution.
  Outcome outcome(std::size_t row) const {
    return resolutions_[row].round() > base_ ? resolutions_[row].outcome() : Outcome::stands;
  }
  /// Number of rounds of the last resolution: 1 if no body had to wait for the outcome of another; 0 before
  /// the first resolution.
  std::uint64_t rounds() const { return rounds_; }
  /// Upper bound on the distance that the origin of any body, driven or pushed, moved in the last resolution,
  /// m; 0 before the first resolution.
  double longest() const { return longest_; }
  /// All pushes of the last resolution, in any order. If a body was pushed several times, it has several
  /// entries, and is_last() is true for exactly one of them: the one with its final position.
  std::span<const Push> pushes() const { return {pushes_.data(), push_count_}; }
  /// Whether a push is the last one of its row. `push` must be a reference to an element of pushes(), not a
  /// copy.
  bool is_last(const Push& push) const { return pushed_last_[push.row] == &push - pushes_.data() + 1u; }
  /// The pushes that a row of this rank has made as a pusher.
  std::span<const Push> pushes_by(std::size_t row) const {
    if (zones_.empty() || zones_[row] == Zone::plain || outcome(row) != Outcome::moved) return {};
    return {pushes_.data() + pushes_of_[row].first, pushes_of_[row].count};
  }
  /// Number of the round in which a row that proposed a motion was resolved. The count of rounds continues
  /// from tick to tick. Rows that depend on this row were resolved in later rounds.
  std::uint32_t round_of(std::size_t row) const { return resolutions_[row].round(); }

 private:
  class Resolver;
  /// The outcome of a row and the round of resolution that found it, in one word that is read and written
  /// atomically.
  class Resolution {
   public:
    Resolution() = default;  ///< of round 0: not resolved; rounds are counted from 1
    Resolution(std::uint32_t round, Outcome outcome)
        : word_(round * k_outcomes + static_cast<std::uint32_t>(outcome)) {}
    std::uint32_t round() const { return word_ / k_outcomes; }
    Outcome outcome() const { return static_cast<Outcome>(word_ % k_outcomes); }

   private:
    static constexpr std::uint32_t k_outcomes = 4;
    std::uint32_t word_ = 0;
  };
  /// A row on which the outcome of another row depends, and how, in one word.
  class Dependency {
   public:
    Dependency() = default;  ///< leaves the members uninitialised
    /// if_moved: true: `row` blocks the dependent row only if `row` has moved; false: only if `row` has not
    /// moved
    Dependency(std::uint32_t row, bool if_moved) : word_(2 * row + (if_moved ? 1 : 0)) {}
    std::uint32_t row() const { return word_ / 2; }
    bool if_moved() const { return word_ % 2 != 0; }

   private:
    std::uint32_t word_;
  };
  /// A row that waits for other rows. These are listed at [first, first + count) of others_, unless `count`
  /// is k_unlisted or k_in_zone (engine/conflicts/conflict_resolver.hpp).
  struct Waiting {
    std::uint32_t row;
    std::uint32_t first;
    std::uint32_t count;
  };
  /// Whether a mover can push bodies in its zone (see `source`, above). `plain`: it cannot, because the zone
  /// contains no pushable body or the mover pushes no bodies. `pushes`: it can. `may_push`: it cannot, but
  /// another mover may push a body into the zone. That body then blocks the mover, because only movers with
  /// the zone `pushes` push (class Conflicts, `pushing`). Without this rule, a body could be pushed from zone
  /// to zone without a limit, so that no mover would be certain to be out of reach of all pushes.
  enum class Zone : std::uint8_t { plain, pushes, may_push };
  static constexpr std::size_t k_max_far = 64;

  void reserve(std::size_t rows, std::size_t most_pushes, const Pushables& pushables);
  void resolve_waiting(std::size_t waiting, Resolver& resolver, partition::Parallel& parallel);
  void finish_with(Border& border, Resolver& resolver, partition::Parallel& parallel);

  // One per row. The count of rounds continues from tick to tick, so entries of earlier ticks need not be
  // cleared: their rounds do not exceed base_.
  std::vector<Resolution> resolutions_;
  std::uint32_t base_ = 0;
  std::uint64_t rounds_ = 0;
  std::uint32_t received_round_ = 0;  // round, counted from base_, to which the outcomes of ghosts belong
  double longest_ = 0;

  // Lists to which threads append in any order. No outcome depends on that order. Unused if no body waits.
  std::size_t reserved_ = 0;
  std::unique_ptr<Waiting[]> waiting_;
  std::unique_ptr<Waiting[]> still_waiting_;
  std::unique_ptr<Dependency[]> others_;
  std::array<std::uint32_t, k_max_far> far_;

  // Only used if bodies can be pushed. An entry of pushes_ is written once and then never changed; a further
  // push of a row gets a new entry. So a thread that reads a position while another thread pushes the row
  // finds either the old or the new position, and never a mixture.
  /// The pushes that a row made as a pusher: [first, first + count) of pushes_.
  struct PushesOf {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::vector<Zone> zones_;
  std::vector<PushesOf> pushes_of_;
  std::vector<Push> pushes_;
  std::size_t push_count_ = 0;  // entries in use of pushes_. Accessed atomically while threads resolve rows
  std::vector<std::uint32_t>
      pushed_last_;  // one per row: index of its last push in pushes_, plus 1; 0: none. Accessed atomically
};

}  // namespace troupe::engine
