#pragma once

#include "engine/kinds/components.hpp"
#include "engine/state/free_circle.hpp"
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

/// Which bodies can be pushed, and how many bodies each body can push in a tick (its *push limit*). A *row*
/// is the index of a body in the state tables. If the world has pushable bodies, both spans have one entry
/// per row. Otherwise both spans are empty, and the numbers have no meaning.
struct Pushables {
  std::span<const std::uint8_t> is_pushable;  ///< 1 if the row's body can be pushed, otherwise 0
  std::span<const std::uint8_t> limits;       ///< push limit of the row's body, 0 to k_most_pushed
  double radius = 0;                          ///< radius of the largest pushable body about its origin, m
  double thinnest = 0;                        ///< width of the thinnest part of all pushable bodies, m
  std::size_t most = 0;                       ///< sum of `limits` over all rows

  bool any() const { return !is_pushable.empty(); }  ///< whether the world has pushable bodies
};

/// Decides which bodies move in a tick, and which bodies they push. The *static scene* is the geometry of the
/// bodies that do not move during a run. It consists of *solids*, which are extruded polygons. Two bodies
/// overlap only if they also overlap in height.
///
/// rule    Bodies take turns. The body that has its turn is called the *mover*. It moves to its proposed pose
///         if it overlaps neither the static scene nor another body on the way. Otherwise its motion is
///         *blocked*, and it stays at its old pose. The other bodies are tested at the poses that they have
///         at this turn: at their new poses if they have already moved, and otherwise at their old poses.
///
///         The order of the turns is given by the *priority* of the bodies, the hash mix(seed, tick, id). The
///         body with the lowest hash has the first turn. If hashes are equal, the lower id goes first.
///
///         There are two exceptions:
///         - Bodies that only touch do not block each other.
///         - What the mover overlaps already, because it was placed so, does not block a motion that takes
///         the
///           mover no deeper into it: at each sample, the depth of each piece of the mover in each piece of a
///           solid or of another body is at most as great as at the sample before (partition::deepens()).
///
/// samples A motion is tested at n equally spaced poses, its *samples*. The last sample is Motion::to. n is
///         the displacement divided by a quarter of the width of the mover's thinnest part, rounded up, but
///         at least 1 and at most 10,000. The displacement is an upper bound on the distance that any
///         vertex moves: length of the translation + radius of the body * absolute value of the turn.
///
///         Between two samples, a body thus moves by at most a quarter of the width of its thinnest part. No
///         other body, however thin, can pass through it completely. A thin body may cut a corner of a part,
///         less than a quarter of the part's width deep.
///
/// pushing The *zone* of a mover is a circle about its old position. It contains everything that the mover
///         could touch or push in the tick. A *pusher* is a mover whose push limit (Pushables::limits) is
///         above 0 and in whose zone there was a pushable body before the tick. Only pushers push. A pushable
///         body that overlaps the pusher at the pusher's old pose is not pushed: it is treated as in `rule`.
///
///         The samples of a pusher are computed with the width of the thinnest part of the pusher and of all
///         pushable bodies. At each sample there are up to k_push_passes *passes*, until none of these
///         bodies overlap. In a pass, the pusher has the first turn. The bodies that it has pushed so far
///         follow, in the order in which they were first pushed. Each of them shifts the bodies that it
///         overlaps, except those that come before it. Each shift is the shortest displacement that separates
///         two bodies (partition::way_out()), plus k_rounding_m. If a body overlaps several bodies, it shifts
///         them in the order of their ids. Pushed bodies do not turn, and stop when the pusher stops.
///
///         The motion of the pusher is blocked, and no body is pushed, in each of these cases:
///         - More bodies would be pushed than the push limit allows.
///         - The last allowed pass at a sample still shifts a body.
///         - A pushed body would be shifted by more than half the width of its thinnest part between two
///           samples.
///         - The new position of a pushed body would be out of bounds.
///         - A pushed body would overlap the static scene, or a body that is not pushed. The exceptions of
///           `rule` apply.
///
///         Several pushers may push the same body in a tick, one after another.
///
/// turning A body that may turn (Crowd::turns) and whose motion is blocked makes the turn of the motion at
/// its old
///         position, if this is not blocked either by `rule`, nor by a pushable body. Its outcome is then
///         Outcome::turned.
///
/// result  The outcome of each body is that of these sequential rules, on any number of threads. What blocked
///         a body (Contact) is defined, not found: it is what blocks the motion at its earliest blocked
///         sample, with all bodies where they are at the turn of the mover. If a pusher's own way is free at
///         a sample, the first of the bodies pushed there counts that cannot go on, in the order in which
///         they were first pushed, and what stops it by the same rule.
///
/// source  Deterministic reservations: Blelloch, Fineman, Gibbons, Shun: Internally deterministic parallel
///         algorithms can be fast, PPoPP 2012. Bodies are resolved in *rounds*. A mover *depends* on another
///         moving body of higher priority if that body would block it at only one of its two poses, the old
///         or the new one. Nearly all movers depend on no other body, and are resolved in the first round.
///         Each of the other movers waits for later rounds, until the bodies that it depends on are resolved,
///         or until one of them blocks it. A different rule holds for a pusher, and for a mover whose zone
///         overlaps that of a pusher: it waits for all movers of higher priority whose zones overlap its
///         zone.
///
/// memory  Grows with the number of rows. resolve() allocates memory only in these cases:
///         - The number of rows exceeds the allocated memory, or is less than about two thirds of it
///           (base/capacity.hpp).
///         - The sum of the push limits of all rows is larger than ever before.
///         - There are more than 512 bodies in the zone of a mover.
class Conflicts {
 public:
  static constexpr int k_push_passes = 16;  ///< largest number of passes: see `pushing`, above

  /// What blocked the motion of a body, and where. All members are zero if nothing did.
  struct Block {
    Contact contact;            ///< what blocked it; never Contact::k_joint
    std::uint32_t sample = 0;   ///< earliest blocked sample, from 1 to `samples`; 0 for Contact::k_bounds
    std::uint32_t samples = 0;  ///< number of samples of the motion; 0 for Contact::k_bounds
    Transform at;               ///< place of the blocking body at this turn, unless it is static; world frame
    double z = 0;               ///< height of the blocking body at this turn, unless it is static, m
  };

  /// The bodies of a tick, with the motions that they propose. Every span has one entry per row; the spans in
  /// `pushables` may be empty instead.
  struct Crowd {
    std::span<const Pose> poses;            ///< old poses, world frame
    std::span<const Transform> transforms;  ///< the old poses as transforms, bit for bit Transform(pose)
    std::span<const Motion> motions;        ///< proposed motions
    /// Shapes of the bodies as obstacles, body frame. A body with an empty shape blocks no other body and is
    /// never blocked.
    std::span<const partition::ObstacleShape* const> shapes;
    std::span<const std::uint32_t> ids;  ///< ids of the bodies; no two are equal
    /// A cache that saves time and changes no outcome. resolve() reads and updates it. The caller keeps it
    /// from tick to tick, and resets the circles to FreeCircle() when the static scene changes.
    std::span<FreeCircle> free;
    std::uint64_t seed = 1;                    ///< seed of the world, for priorities
    std::uint64_t tick = 0;                    ///< the current tick, for priorities
    Box bounds;                                ///< box in which motions must end, m, world frame
    Pushables pushables = {};                  ///< which bodies can push or be pushed; empty: none
    std::span<const std::uint8_t> turns = {};  ///< 1: a body that may turn (`turning`); empty: none may
    /// Output of resolve(): what blocked each row of this rank. Empty: it is not computed.
    std::span<Block> blocks = {};
  };

  /// A push of a body. The height and heading of the body do not change.
  struct Push {
    std::uint32_t row;  ///< row of the pushed body
    Vec2 position;      ///< new position of its origin, m, world frame
  };

  /// The outcome of the motion of a body.
  enum class Outcome : std::uint8_t {
    stands,   ///< the body proposed no motion; it may have been pushed (pushes())
    moved,    ///< the body is at its proposed pose
    turned,   ///< the body is at its old position, with its proposed heading (class Conflicts, `turning`)
    blocked,  ///< the body stays at its old pose, because another body is in its way, mobile or static
    out_of_bounds,  ///< the body stays at its old pose, because the motion would end outside Crowd::bounds
  };

  /// The connection to the other ranks, if several ranks (threads or processes that compute a world together)
  /// resolve the motions of one tick. Each rank *owns* some of the rows and resolves their motions. In
  /// addition it has *ghosts*: copies of those rows of other ranks that may block its own rows or be blocked
  /// by them.
  class Border {
   public:
    virtual ~Border() = default;
    /// Called at the beginning of a resolution. Returns the elements of `order` that this rank owns. All
    /// other elements are ghosts.
    ///
    /// motions: the proposed motions, one per row
    /// order: all rows in the spatial index
    virtual std::span<const std::uint32_t> begin(std::span<const Motion> motions,
                                                 std::span<const std::uint32_t> order) = 0;
    /// Exchanges outcomes with the other ranks:
    /// - Sends outcome() and pushes_by() of own rows to the ranks that have ghosts of these rows.
    /// - Receives the outcomes and pushes of ghosts, and passes them to receive(). If a body was pushed
    ///   several times, its pushes must be passed on in the order of the rounds (round_of()) in which they
    ///   were made.
    ///
    /// Conflicts::resolve() calls this each time when no own row can be resolved until more outcomes of
    /// ghosts are known, and after all own rows are resolved. The last call in a tick returns false: then
    /// all outcomes of own rows have been sent, and those of all ghosts have been received.
    virtual bool exchange(Conflicts& conflicts) = 0;
    /// Exchanges the final positions of pushed bodies. Called at the end of a resolution. If a row of this
    /// rank made the last push of a body, sends the final position of the body to all other ranks. Passes
    /// each final position that it receives to receive_place(), if the body has a row on this rank.
    /// exchange() does not suffice for this: a rank may have a row of a pushed body, but no ghost of the body
    /// that pushed it last.
    virtual void exchange_places(Conflicts& conflicts) = 0;
  };

  /// Resolves all motions of a tick, on the threads of `parallel`. The results are outcome() and pushes().
  /// This function does not change the poses in `crowd`; the caller must apply the results to them.
  ///
  /// index: the spatial index, with the rows at their old poses. A row that it does not contain, such as that
  /// of a dead body, must propose no motion, and does not block other bodies.
  /// border: the connection to the other ranks, if `crowd` has ghosts; otherwise null
  void resolve(const Crowd& crowd, const partition::StaticScene& scene, const partition::BodyIndex& index,
               partition::Parallel& parallel, Border* border = nullptr);
  /// Stores the outcome of the motion of a ghost, and the pushes that the ghost made. `pushes` must contain
  /// only bodies that have a row on this rank. Border::exchange() calls this for each outcome that it
  /// receives.
  void receive(std::uint32_t row, Outcome outcome, std::span<const Push> pushes);
  /// Stores the final position of a pushed body. Border::exchange_places() calls this.
  void receive_place(const Push& push);

  /// Overwrites the results and the internal data of earlier resolutions with junk. Tests call this to show
  /// that the next resolution does not depend on them. Until the next resolution, outcome() is
  /// Outcome::stands, pushes() is empty, rounds() is 0 and longest() is NaN.
  void forget();

  /// Outcome of a row in the last resolution. `row` must be less than the number of rows of that resolution.
  /// While a resolution runs, a row that is not yet resolved has Outcome::stands.
  Outcome outcome(std::size_t row) const {
    return resolutions_[row].round() > base_ ? resolutions_[row].outcome() : Outcome::stands;
  }
  /// Number of rounds (class Conflicts, `source`) of the last resolution: 1 if no body had to wait for the
  /// outcome of another body; 0 before the first resolution.
  std::uint64_t rounds() const { return rounds_; }
  /// Upper bound on the distance that the origin of any body, driven or pushed, moved in the last resolution,
  /// m; 0 before the first resolution.
  double longest() const { return longest_; }
  /// All pushes of the last resolution, in any order. If a body was pushed several times, it has several
  /// entries, and is_last() is true for exactly one of them: the one with its final position.
  std::span<const Push> pushes() const { return {pushes_.data(), push_count_}; }
  /// Whether a push is the last push of its body. `push` must be a reference to an element of pushes(), not
  /// to a copy.
  bool is_last(const Push& push) const { return pushed_last_[push.row] == &push - pushes_.data() + 1u; }
  /// The pushes that a row of this rank made in the last resolution; empty if it pushed no body.
  std::span<const Push> pushes_by(std::size_t row) const {
    if (zones_.empty() || zones_[row] == Zone::plain || outcome(row) != Outcome::moved) return {};
    return {pushes_.data() + pushes_of_[row].first, pushes_of_[row].count};
  }
  /// Number of the round in which a row that proposed a motion was resolved. The numbers increase from tick
  /// to tick. Of two rows that pushed the same body, the row that pushed it later has the higher number.
  std::uint32_t round_of(std::size_t row) const { return resolutions_[row].round(); }

 private:
  class Resolver;
  /// The outcome of a row and the number of the round that found it, packed into one word that is read and
  /// written atomically.
  class Resolution {
   public:
    Resolution() = default;  ///< of round 0: not resolved; rounds are counted from 1
    Resolution(std::uint32_t round, Outcome outcome)
        : word_(round * k_outcomes + static_cast<std::uint32_t>(outcome)) {}
    std::uint32_t round() const { return word_ / k_outcomes; }
    Outcome outcome() const { return static_cast<Outcome>(word_ % k_outcomes); }

   private:
    static constexpr std::uint32_t k_outcomes = 5;
    std::uint32_t word_ = 0;
  };
  /// A row of higher priority on which a waiting row depends (class Conflicts, `source`), packed into one
  /// word. It blocks the waiting row either only if it has moved or only if it has not moved. Rows that
  /// depend on one that may turn list no dependencies.
  class Dependency {
   public:
    Dependency() = default;  ///< leaves the members uninitialised
    /// if_moved: true: `row` blocks the waiting row only if `row` has moved; false: only if `row` has not
    /// moved
    Dependency(std::uint32_t row, bool if_moved) : word_(2 * row + (if_moved ? 1 : 0)) {}
    std::uint32_t row() const { return word_ / 2; }
    bool if_moved() const { return word_ % 2 != 0; }

   private:
    std::uint32_t word_;
  };
  /// A row that waits until other rows are resolved. Its dependencies are the elements [first, first + count)
  /// of others_. With two special values of `count`, no dependencies are listed: k_unlisted, if there are too
  /// many of them, and k_in_zone, if the row waits for movers with overlapping zones, of which `first` is one
  /// (engine/conflicts/conflict_resolver.hpp).
  struct Waiting {
    std::uint32_t row;
    std::uint32_t first;
    std::uint32_t count;
  };
  /// How pushes may affect a mover (class Conflicts, `pushing`):
  /// - `plain`: no body can be pushed in its zone.
  /// - `pushes`: the mover is a pusher.
  /// - `may_push`: the mover is no pusher, but its zone overlaps that of a pusher, so that a body may be
  ///   pushed into its zone. Such a body blocks the mover, even if the push limit of the mover is above 0. If
  ///   the mover could push the body on, bodies could be pushed from zone to zone without a limit.
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
  // One per row: index of its last push in pushes_, plus 1; 0: none. Accessed atomically.
  std::vector<std::uint32_t> pushed_last_;
};

}  // namespace troupe::engine
