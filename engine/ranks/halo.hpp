#pragma once

#include "base/ids.hpp"
#include "engine/links/links.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_border.hpp"
#include "engine/ranks/rank_work.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/world.hpp"
#include "partition/message.hpp"
#include "partition/tile_owners.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// Returns the reason why the rows of a world cannot be distributed among ranks (class Halo), for example
/// `the world uses the grid ray engine`. The text is empty if the rows can be distributed.
std::string why_replicated(const World& world);

/// How a world would be divided among ranks, which are threads or processes. A row is the data of one body in
/// the state tables. Each rank owns a part of the plane (its ground), and the rows of the bodies there.
struct HaloPlan {
  struct Rank {
    std::size_t own = 0;         ///< number of rows that the rank owns
    std::size_t ghosts = 0;      ///< number of ghosts of the rank: its copies of rows of other ranks
    std::size_t neighbours = 0;  ///< number of other ranks with which the rank exchanges data of ghosts
  };
  double coverage_m = 0;    ///< a row is a ghost on ranks that own ground within this distance of its body, m
  std::vector<Rank> ranks;  ///< one entry per rank
};
/// Returns how a Halo would divide the rows of a world among `ranks` ranks, with the bodies at their present
/// positions. `world` must have all rows, and why_replicated() must return an empty text.
///
/// longest_motion: longest motion of a body in a tick (time step), m
HaloPlan plan_halo(const World& world, unsigned ranks, double longest_motion);

/// The *distributed* form of a world that several ranks (threads or processes) compute together. A row is the
/// data of one body in the state tables. The plane is divided among the ranks (partition::TileOwners). A rank
/// *owns* its part of the plane, which is its ground, and the rows of the bodies there. In addition, it has
/// *ghosts*: copies of rows of other ranks. The bodies of the ghosts are those that may affect the bodies of
/// the own rows in a tick (time step).
///
/// A *tree* is a body that is not carried (the root), together with all bodies that it carries, directly or
/// through others. A body that neither carries nor is carried is also a tree. The *place* of a body is the
/// position of the root of its tree. To *distribute* the rows is to give each row to the rank that owns the
/// ground at the place of its body, and to make all ghosts again. Between two distributions, a row keeps its
/// owner even if its body moves to other ground.
///
/// owners  All bodies of a tree have the same place. Their rows therefore have the same owner, and are ghosts
///         on the same ranks.
/// rows    On each rank, the own rows come first, then the ghosts. Sensors, devices and controllers run for
///         own rows only. Motions are computed for all rows: those of ghosts from the velocities that their
///         owners send.
/// ghosts  A row is a ghost on each rank that owns ground within the *coverage* of the place of its body. The
///         coverage is the sum of two lengths. The first length is the largest distance at which two bodies
///         can affect each other in this tick or in the sensing of the next tick (Extent::of_all()). The
///         second length is a margin, the *skin*, with which the ghosts remain sufficient while the bodies
///         move. In each tick, two bodies can approach each other by twice the longest motion of a body. When
///         the sum of these approaches since the last distribution exceeds the skin, all ranks distribute the
///         rows again. All ranks know the longest motion of a tick before any body moves, so they make the
///         same decision.
/// guests  Some devices can act on bodies at any distance (ApplyScope::any_target). If such a device acts on
///         a body, the rows of that body's tree become ghosts on the rank that owns the row of the device's
///         body. They remain ghosts until the rows are distributed again (Guest).
/// lives   Unborn bodies (not yet in the world) and dead bodies have no ghosts, except as guests. The place
///         of an unborn body is the origin of the world frame, and the place of a dead body is where it died.
///         All ranks know of each birth, and distribute the rows before the next sensing.
/// moves   Each rank decides which motions of its own rows are blocked. If this depends on the motion of a
///         ghost, the rank waits until the owner of the ghost has sent the outcome of that motion (class
///         RankBorder).
/// joints  The *goal* of a joint is the pose to which a device moves the joint in a tick. The owner of a
///         ghost sends the goals of the body's joints. Each rank then decides which joint motions of its own
///         rows are blocked. It does so in rounds, and after each round the ranks exchange the results for
///         ghosts (class RankBorder).
/// cargo   If devices attach bodies to others or release them, all ranks distribute the rows in the same
///         tick, unless the ghosts suffice for the new trees (suffices_for()).
/// pushes  The owner of a body sends the pushes by that body together with the outcome of its motion. A rank
///         with a ghost of a pushed body may lack ghosts of some bodies that push it. When all motions are
///         decided, all ranks therefore exchange the final positions of pushed bodies.
///
/// No result of a run depends on which rank owns a row, on the skin, or on how often rows are distributed.
class Halo {
 public:
  /// Margin for the rounding of distances, radii and motions, m. Up to 10 km from the origin, it exceeds the
  /// amount by which the spatial index enlarges the circles of bodies (partition::enclosing_circle()). The
  /// rounding of positions is much smaller: at most 5e-10 m for coordinates of up to 2,000 km.
  static constexpr double k_slack_m = 1e-3;

  /// A tree on which a device acts from any distance. Its rows must be own rows or ghosts of the rank that
  /// owns the ground at `host`, because that rank applies the action.
  struct Guest {
    BodyId root;               ///< root of the tree
    Vec2 host = Vec2::Zero();  ///< place of the body whose device acts on the tree, m, world frame
  };
  /// Lengths that limit how far bodies can affect one another, m. of_sensing(), of_motions() and of_all()
  /// return distances between the places of two bodies, m. The argument `longest` is the longest motion of a
  /// body in the tick, m.
  struct Extent {
    double reach = 0;            ///< longest reach of a device (Settings::longest_reach())
    double shift = 0;            ///< longest distance by which the joints of a body can shift its devices
    double radius = 0;           ///< largest radius of a body or tree, for all poses of its joints
    bool has_trees = false;      ///< whether bodies can carry others
    double push_reach = 0;       ///< greatest length of a chain of bodies that one body pushes
    bool has_pushable = false;   ///< whether the world has pushable bodies
    double pushable_radius = 0;  ///< largest radius of a pushable body

    /// Upper bound on the radius of a zone. The *zone* of a body is a circle about the body that contains
    /// everything that its motion could touch or push in a tick.
    double zone(double longest) const;
    double of_sensing() const;  ///< largest distance at which a device of one body can sense another body
    /// Largest distance at which a body can affect the outcome of the motion of another body in the tick. If
    /// bodies can be pushed, a motion depends on all bodies in the zone of its body, on all moving bodies
    /// whose zones overlap that zone, and on the bodies that those moving bodies push. The distance is then
    /// at least three times zone() plus pushable_radius.
    double of_motions(double longest) const;
    /// Largest distance at which a body can affect another body in the tick or in the sensing of the next
    /// tick: the coverage without the skin.
    double of_all(double longest) const;
  };
  static Extent extent_of(const World& world);  ///< the extent for all bodies of a world

  /// `world` must have all rows, and why_replicated(world) must return an empty text. `tables` are the state
  /// tables of the world, and `links` its joints. World, tables and links must outlive this object. Call
  /// divide() next.
  ///
  /// sent: indices of the tables whose rows owners send in each tick to the ranks with ghosts (Sharing::sent)
  /// cut_seed: for tests; if set, each distribution divides the plane among the ranks at random, and the rows
  /// are also distributed in random ticks
  /// skin_m: the skin (see `ghosts`), m. Not set: 16 times the longest motion in a tick or, if `cut_seed` is
  /// set, a random multiple of that motion
  Halo(World& world, RankAccess& access, std::vector<std::size_t> sent, RankPost post,
       std::optional<std::uint64_t> cut_seed, std::optional<double> skin_m);

  /// Distributes the rows for the first time. Before the call, each rank must have all rows, with the same
  /// state. Afterwards, it has only its own rows and its ghosts. Sends no messages.
  void divide();
  /// Called on all ranks: distributes the rows. The own rows are the first own() rows, before and after the
  /// call.
  ///
  /// longest: longest motion of any body when bodies move next, m; 0 if it is not yet known
  /// guests: trees that must also be ghosts on other ranks (Guest); the same on all ranks, in any order
  void distribute(double longest, std::span<const Guest> guests = {});
  /// Upper bound on the length of the motions of the bodies of own rows in this tick, m. It follows from the
  /// velocities that their drives have computed, so pushes do not count.
  double longest_motion() const;
  /// Called on all ranks: divides the plane among the ranks again, so that all ranks would take about the
  /// same time. Assumes that all rows of a rank took equally long. distribute() must follow.
  ///
  /// times: the time that each rank took for its own rows, one per rank, in any unit; the same on all ranks
  void balance(std::span<const std::uint64_t> times);
  /// Called on all ranks in each tick, before any body moves. Distributes the rows if `distributes` is true,
  /// or if the ghosts may not suffice for the motions of this tick and the next sensing.
  ///
  /// longest: longest motion of a body on any rank in this tick, m
  /// guests: see distribute()
  void prepare_motions(double longest, bool distributes, std::span<const Guest> guests);

  bool has_trees() const { return extent_.has_trees; }  ///< whether bodies can carry others
  /// Whether this rank owns the row of a body, and the body carries others.
  bool has_cargo(BodyId body) const;
  /// Whether the ghosts of all ranks suffice for the present tree of an own row. Call this if the body of the
  /// row may have joined or left a tree since the last distribution. The ghosts suffice if all of these hold:
  /// - this rank owns the ground at the root of the tree;
  /// - the radius of the tree is at most Extent::radius, the largest radius of a tree at a distribution so
  ///   far;
  /// - the body and the root of its tree are ghosts on the same ranks;
  /// - these ranks include all ranks that own ground near the root. Ground is near if its distance from the
  ///   root is at most the coverage minus the longest distance that a body may have moved since the last
  ///   distribution.
  bool suffices_for(Row row) const;
  /// Call this after get_state() has overwritten the rows `ghosts`, because other bodies may now carry their
  /// bodies. Finds the trees of all rows on this rank again, and updates the shapes of these ghosts for
  /// conflict resolution (Links::reshape()).
  void link_again(std::span<const Row> ghosts);
  std::size_t own() const { return own_; }        ///< number of own rows
  double reach() const { return extent_.reach; }  ///< longest reach of devices for which ghosts suffice, m
  /// Whether the ghosts may no longer suffice for sensing, because bodies have moved or were pushed too far
  /// since the last distribution. The rows must then be distributed before any sensor runs. The result is the
  /// same on all ranks.
  bool lacks_ghosts();
  /// The object that exchanges the outcomes of motions with other ranks. prepare_motions() must have been
  /// called in this tick.
  RankBorder& border() { return border_; }
  /// The transfer of a tree to another owner, wherever the tree is.
  struct Gift {
    BodyId root;        ///< root of the tree
    unsigned from = 0;  ///< the rank that owns the rows of the tree before the transfer
    unsigned to = 0;    ///< the rank that owns them after the transfer
  };
  /// Called on all ranks at the end of the phase move, before the spatial index is rebuilt: transfers trees
  /// to other owners. Ranks that give or get trees then have no ghosts, so distribute() must follow.
  ///
  /// gifts: the transfers, sorted by Gift::root; the same on all ranks
  void give(std::span<const Gift> gifts);
  /// Appends the data that rank `to` needs from this rank before bodies move. For each body whose row is an
  /// own row here and a ghost on rank `to`, these are its rows in the tables with Sharing::sent and the goals
  /// of its joints.
  void put_shown(unsigned to, partition::MessageWriter& message) const;
  /// Reads what put_shown() of rank `from` has appended, and updates the ghosts on this rank.
  void get_seen(unsigned from, partition::MessageReader& message);

  std::vector<Row> tree(Row row) const;  ///< rows of all bodies of the tree of the row's body; root first
  Vec2 place(Row row) const;             ///< place of the row's body, m, world frame
  /// The rank that owns the row of a body. This rank must have the row, as own row or ghost.
  unsigned owner(BodyId body) const;
  /// The rank that owns the ground at a point (m, world frame).
  unsigned owner_at(const Vec2& point) const { return owners_.owner(point); }
  /// The bodies of own rows that are ghosts on rank `to`, in the order of ids.
  std::span<const BodyId> shown(unsigned to) const { return shown_[to]; }
  /// The bodies of ghosts on this rank whose rows rank `from` owns, in the order of ids.
  std::span<const BodyId> seen(unsigned from) const { return seen_[from]; }
  /// Appends the state of a body. This rank must have the row of the body, as own row or ghost.
  void put_state(partition::MessageWriter& message, BodyId body) const;
  /// Reads what put_state() has appended for a body, and overwrites the state of the body on this rank. This
  /// rank must have the row of the body, as own row or ghost.
  void get_state(partition::MessageReader& message, BodyId body);

  /// Appends all data of the own rows, for complete() on rank 0.
  void put_own(partition::MessageWriter& message) const;
  /// On rank 0: replaces the ghosts by all rows of the other ranks. `messages` has one message from each
  /// other rank, to which put_own() has appended the rows. Afterwards, rank 0 has all rows, and own() is as
  /// before.
  void complete(std::span<ReceivedOrder> messages);
  /// Undoes complete(): keeps only the own rows and the ghosts.
  void forget_completion();
  bool is_complete() const { return is_complete_; }  ///< whether this rank has all rows
  /// Makes all rows of the world own rows of this rank. The rows that this rank does not have are filled with
  /// zeros.
  void own_all();
  /// Removes all rows from this rank. Called if another rank calls own_all().
  void own_none();

  /// What this rank has counted. `messages` and `bytes` are not counted here, and are 0.
  RankCounts counts() const {
    RankCounts counts = counts_;
    counts.rounds = border_.rounds();
    return counts;
  }

  /// hash_shown(): sum of the hashes of the own rows that are ghosts on rank `to`. hash_seen(): sum of the
  /// hashes of the ghosts on this rank whose rows rank `from` owns. Between two ticks, hash_shown(b) on rank
  /// a equals hash_seen(a) on rank b.
  ///
  /// is_known: one entry per state table; the sums include the tables whose entry is not 0
  ///@{
  std::uint64_t hash_shown(unsigned to, std::span<const std::uint8_t> is_known) const {
    return hash(shown_rows_[to], is_known);
  }
  std::uint64_t hash_seen(unsigned from, std::span<const std::uint8_t> is_known) const {
    return hash(seen_rows_[from], is_known);
  }
  ///@}

 private:
  struct Goal {  // of a joint in this tick
    BodyId body;
    std::uint32_t joint;
    Pose goal;
  };
  struct Arrival {  // a row that another rank has sent, or that changes from own to ghost
    RowState state;
    Vec2 place;
    std::vector<Goal> goals;
  };
  void put_row(partition::MessageWriter& message, Row row) const;
  Arrival get_row(partition::MessageReader& message) const;
  void send_rows(std::vector<BodyId>& leaving, std::vector<Arrival>& arrivals);
  void receive_rows(std::vector<Arrival>& arrivals);
  void exchange_rows(std::span<const BodyId> leaving, std::vector<Arrival>& arrivals);
  void choose_coverage(double longest);
  void agree_on_trees();
  std::vector<Goal> goals_of(RowRange rows) const;
  void set_goals(std::span<const Goal> goals);
  void note_pushes();
  std::vector<unsigned> shown_to(BodyId body) const;
  void find_ranks_near(Row row, std::vector<unsigned>& near) const;
  void cut_again();
  void note_neighbours();
  void find_rows();
  std::uint64_t hash(std::span<const std::uint32_t> rows, std::span<const std::uint8_t> is_known) const;

  World& world_;
  RankAccess& access_;
  std::span<StateTable> tables_;
  Links& links_;
  std::vector<std::size_t> sent_;
  RankPost post_;
  std::optional<std::uint64_t> cut_seed_;
  std::optional<double> skin_m_;

  // Its `reach` is as of the last distribution. Its `radius`, if it has trees, is that of the largest tree
  // that any rank had at a distribution since rank 0 last had all rows as its own.
  Extent extent_;
  std::vector<partition::TileOwners::Key> keys_;  // of the bodies at tick 0, ascending; only with cut_seed_
  partition::TileOwners owners_;
  std::size_t own_ = 0;
  bool is_complete_ = true;
  std::vector<Guest> guests_;  // of the last distribution, in the order of roots
  double coverage_ = 0;        // m: see class Halo
  double longest_ = 0;         // longest motion of a body in this tick that its drive proposed, m
  double moved_ = 0;           // upper bound on the distance that a body moved since the last distribution, m
  // One entry per rank: bodies of own rows that the rank has as ghosts, and of ghosts that the rank owns;
  // both in the order of ids. And the same as rows.
  std::vector<std::vector<BodyId>> shown_;
  std::vector<std::vector<BodyId>> seen_;
  std::vector<std::vector<std::uint32_t>> shown_rows_;
  std::vector<std::vector<std::uint32_t>> seen_rows_;
  RankBorder border_;
  std::uint64_t neighbours_ = 0;  // number of ranks with which this rank has ghosts in common
  RankCounts counts_;             // without `rounds`
};

}  // namespace troupe::engine
