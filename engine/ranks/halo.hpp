#pragma once

#include "base/ids.hpp"
#include "engine/links/links.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_border.hpp"
#include "engine/ranks/rank_work.hpp"
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

/// Returns why the rows of a world cannot be distributed among ranks (class Halo), for example `the world
/// uses the grid ray engine`. The text is empty if the rows can be distributed.
std::string why_replicated(const World& world);

/// How the rows of a world would be divided among ranks (class Halo).
struct HaloPlan {
  struct Rank {
    std::size_t own = 0;         ///< number of rows that the rank owns
    std::size_t ghosts = 0;      ///< number of its ghosts: copies of rows of other ranks
    std::size_t neighbours = 0;  ///< number of ranks that own its ghosts or have ghosts of its rows
  };
  double coverage_m = 0;    ///< a row is a ghost on ranks that own ground within this distance of its body, m
  std::vector<Rank> ranks;  ///< one entry per rank
};
/// Returns how a Halo would divide the rows of a world among `ranks` ranks, with the bodies at their present
/// positions. `world` must have all rows, and why_replicated() must return an empty text.
///
/// longest_motion: longest motion of a body in a tick (time step), m
HaloPlan plan_halo(const World& world, unsigned ranks, double longest_motion);

/// The *distributed* form of a world that several ranks (threads or processes) compute. A row is the data of
/// one body in the state tables. Each rank has only the rows that it owns and *ghosts*: copies of rows of
/// other ranks. The bodies of ghosts are those that may affect the bodies of the own rows in a tick (time
/// step). To *distribute* the rows is to give each row to its owner and to make all ghosts again. A *tree* is
/// a body that is not carried (its root) together with all bodies that it carries, directly or through
/// others.
///
/// owners  The plane is divided among the ranks (partition::TileOwners). A row belongs to the rank that owned
///         the place of its body when the rows were last distributed. The *place* of a body is the position
///         of the root of its tree, or its own position if it is not carried. All bodies of a tree therefore
///         have one owner, and are ghosts on the same ranks.
/// rows    The own rows come first, then the ghosts. Sensing, devices and controllers run for own rows only.
///         Motions are computed for all rows: those of ghosts from the velocities that their owners send.
/// ghosts  A row is a ghost on each rank that owns ground within the *coverage* of its body. The coverage is
///         the sum of two lengths. The first length is the distance at which two bodies can affect each other
///         in this tick or in the sensing of the next tick. It is the larger of A and B, plus twice the
///         longest motion of a body in a tick. A is the sum of the longest reach of a device, the longest
///         shift of a device by joints, and the largest radius of a body or tree. If bodies can carry others,
///         A contains this radius twice, because a carried device may be one radius away from the place of
///         its body. B is twice this radius. The radius of a tree is an upper bound for all poses of its
///         joints. The second length is a margin, the *skin*, with which the ghosts remain valid for some
///         ticks. When twice the sum of the longest motions since the last distribution exceeds the skin, all
///         ranks distribute the rows again. All ranks know the longest motion of the tick before any body
///         moves, so they decide alike.
/// guests  Some devices can act on bodies at any distance (ApplyScope::any_target). The target of such an
///         action, with its tree, is also a ghost on the rank that owns the body of the device, until the
///         rows are distributed again (Guest).
/// lives   Unborn bodies (not yet in the world) and dead bodies have no ghosts, except as guests. The row of
///         an unborn body belongs to the rank that owns the origin of the world, and the row of a dead body
///         to the rank that owns the place where it died. All ranks know of each birth, and distribute the
///         rows after it, before the next sensing.
/// moves   Each rank resolves the motions of its own rows. If a motion depends on the motion of a ghost, it
///         waits until the owner of the ghost has sent the outcome of that motion (class RankBorder).
/// joints  The owner of a ghost sends the poses to which devices move the joints of that body (their goals).
///         Every rank then knows which parts of which trees move. Each rank resolves the motions of the
///         joints of its own rows in rounds. After each round, the owners of ghosts send its outcomes (class
///         RankBorder).
/// cargo   If devices attach bodies to others or release them in a tick, all ranks distribute the rows at the
///         end of the tick, unless the ghosts suffice for the new trees (suffices_for()).
/// pushes  A motion that may push bodies depends on all bodies in its *zone* (a circle that contains
///         everything that the motion could touch or push), on all moving bodies whose zones overlap it, and
///         on the bodies that these moving bodies push. In a world with pushable bodies, the coverage is
///         therefore at least three times the radius of the largest zone, plus the largest radius of a
///         pushable body: a pushable body is in a zone as soon as its enclosing circle touches the zone. The
///         owner of a moving body sends the pushes of that body together with the outcome of its motion. Not
///         every rank with a ghost of a pushed body has ghosts of all bodies that push it, so at the end all
///         ranks exchange the final positions.
///
/// No result of a run depends on which rank owns a row, on the skin, or on how often rows are distributed.
class Halo {
 public:
  /// A tree whose rows must be on the rank that owns the ground at a point, however far away the tree is.
  struct Guest {
    BodyId root;  ///< root of the tree; the body itself if it neither carries others nor is carried
    Vec2 host = Vec2::Zero();  ///< the point: place of the device's body, m, world frame
  };
  /// How far bodies can affect one another. All lengths are in m. The argument `longest` of the functions is
  /// the longest motion of a body in the tick.
  struct Extent {
    double reach = 0;            ///< longest reach of a device
    double shift = 0;            ///< how far joints can move a device of their body from its rest pose
    double radius = 0;           ///< largest radius of a body or tree
    bool has_trees = false;      ///< whether bodies can carry others
    double push_reach = 0;       ///< distance at which a body can push bodies that it does not touch
    bool has_pushable = false;   ///< whether the world has pushable bodies
    double pushable_radius = 0;  ///< largest radius of a pushable body

    double zone(double longest) const;  ///< upper bound on the radius of a zone (class Halo, `pushes`)
    double of_sensing() const;  ///< distance from the place of a body at which its devices can sense bodies
    /// Distance at which bodies can affect the outcome of a motion.
    double of_motions(double longest) const;
    /// Distance at which bodies can affect each other in the tick and in the sensing of the next one: the
    /// coverage without a skin.
    double of_all(double longest) const;
  };
  static Extent extent_of(const World& world);  ///< the extent for all bodies of a world

  /// `world` must have all rows, and why_replicated(world) must return an empty text. `world`, `tables` (its
  /// state tables) and `links` (its joints) must outlive this object. Call divide() next.
  ///
  /// sent: indices of the tables whose rows owners send in each tick (Sharing::sent)
  /// cut_seed: for tests; if set, the ranks own random ground, which is chosen again in some of the ticks
  /// skin_m: the skin (see `ghosts`), m; not set: 16 times the longest motion in a tick, or a random multiple
  /// if `cut_seed` is set
  Halo(World& world, std::span<StateTable> tables, Links& links, std::vector<std::size_t> sent, RankPost post,
       std::optional<std::uint64_t> cut_seed, std::optional<double> skin_m);

  /// Distributes the rows of a world that is complete on all ranks: each rank keeps only its own rows and its
  /// ghosts. Needs no messages.
  void divide();
  /// Gives each row to the rank that owns the place of its body, and makes the ghosts again. Before and after
  /// the call, the own rows are those in [0, own()).
  ///
  /// longest: upper bound on the motions of all bodies in the next tick, m
  /// guests: trees that must also be ghosts on other ranks (Guest); the same on all ranks, in any order
  void distribute(double longest, std::span<const Guest> guests = {});
  /// Upper bound on the length of the motions that own rows will propose in this tick, m.
  double longest_motion() const;
  /// Changes which ground the ranks own, so that all ranks would take about the same time. Assumes that all
  /// rows of a rank took equally long. times: the time that each rank took for its rows, one per rank, in any
  /// unit; the same on all ranks. distribute() must follow.
  void balance(std::span<const std::uint64_t> times);
  /// Called when all ranks know the longest motion of all bodies in this tick, before any body moves.
  /// Distributes the rows if `distributes` is true, or if ghosts may be missing because of motions since the
  /// last distribution or in this tick.
  ///
  /// longest: longest motion of a body in this tick, m
  /// guests: see distribute()
  void prepare_motions(double longest, bool distributes, std::span<const Guest> guests);

  bool has_trees() const { return extent_.has_trees; }  ///< whether bodies can carry others
  /// Whether the row of a body is an own row, and the body carries others.
  bool has_cargo(BodyId body) const;
  /// Whether the ghosts of all ranks suffice for the present tree of an own row. Call this if the body may
  /// have joined another tree since the last distribution, because its place has then changed. The ghosts
  /// suffice if all of these hold:
  /// - the tree would still belong to this rank if the rows were distributed now;
  /// - it is no larger than the largest tree was at a distribution (Extent::radius);
  /// - all its bodies are ghosts on the same ranks;
  /// - these ranks include all ranks that own ground near the root of the tree: nearer than the coverage
  ///   minus the longest distance that a body may have moved since the last distribution.
  bool suffices_for(Row row) const;
  /// Call this after get_state() has changed which bodies carry the bodies of these ghosts. Computes again
  /// which bodies form a tree, and the shapes of the trees of these ghosts.
  void link_again(std::span<const Row> ghosts);
  std::size_t own() const { return own_; }        ///< number of own rows
  double reach() const { return extent_.reach; }  ///< longest device reach for which the ghosts suffice, m
  /// Whether bodies were pushed so far in the last tick that the rows must be distributed before any device
  /// senses again. The result is the same on all ranks.
  bool lacks_ghosts();
  /// The exchange of outcomes of motions. prepare_motions() must have been called in this tick.
  RankBorder& border() { return border_; }
  /// A tree whose rows go to another rank, wherever the tree is.
  struct Gift {
    BodyId root;        ///< root of the tree
    unsigned from = 0;  ///< the rank that owns its rows
    unsigned to = 0;    ///< the rank that owns them afterwards
  };
  /// Called on all ranks, after bodies have moved and before the spatial index is rebuilt (between the phases
  /// move and index): changes the owners of trees. A rank that gives or gets trees then has no ghosts, so
  /// distribute() must follow.
  ///
  /// gifts: the same on all ranks, in the order of roots
  void give(std::span<const Gift> gifts);
  /// Appends data of those own rows that rank `to` has as ghosts: the rows in the tables with Sharing::sent,
  /// and the goals of joints. Rank `to` needs these data before bodies move.
  void put_shown(unsigned to, partition::MessageWriter& message) const;
  /// Reads what put_shown() of rank `from` has appended.
  void get_seen(unsigned from, partition::MessageReader& message);

  std::vector<Row> tree(Row row) const;  ///< rows of all bodies of the row's tree; the root is first
  Vec2 place(Row row) const;             ///< place of the row's body (see `owners`), m, world frame
  /// The rank that owns the row of a body. The body must have a row on this rank, as own row or ghost.
  unsigned owner(BodyId body) const;
  /// The rank that owns the ground at a point (m, world frame) since the last distribution.
  unsigned owner_at(const Vec2& point) const { return owners_.owner(point); }
  /// Bodies of own rows that rank `to` has as ghosts, in the order of ids.
  std::span<const BodyId> shown(unsigned to) const { return shown_[to]; }
  /// Bodies of ghosts that rank `from` owns, in the order of ids.
  std::span<const BodyId> seen(unsigned from) const { return seen_[from]; }
  /// Appends the state of a body that has a row on this rank.
  void put_state(partition::MessageWriter& message, BodyId body) const;
  /// Reads what put_state() has appended, for a body that has a row on this rank.
  void get_state(partition::MessageReader& message, BodyId body);

  /// Appends all data of the own rows.
  void put_own(partition::MessageWriter& message) const;
  /// On rank 0: reads what put_own() of the other ranks has appended, one message each. Afterwards, rank 0
  /// has all rows, and own() is as before.
  void complete(std::span<ReceivedOrder> messages);
  /// Removes the rows that complete() has added.
  void forget_completion();
  bool is_complete() const { return is_complete_; }  ///< whether this rank has all rows
  /// Makes all rows of the world own rows of this rank. A row that only other ranks have becomes a row of
  /// zeros.
  void own_all();
  /// Removes all rows: another rank has all of them.
  void own_none();

  /// What was counted on this rank; without `messages` and `bytes`, which are 0.
  RankCounts counts() const {
    RankCounts counts = counts_;
    counts.rounds = border_.rounds();
    return counts;
  }

  /// hash_shown(): sum of the hashes of the own rows that rank `to` has as ghosts. hash_seen(): sum of the
  /// hashes of the ghosts here that rank `from` owns. Only tables t with is_known[t] != 0 count. Between two
  /// ticks, hash_shown(b) on rank a equals hash_seen(a) on rank b.
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
    World::RowState state;
    Vec2 place;
    std::vector<Goal> goals;
  };
  void put_row(partition::MessageWriter& message, Row row) const;
  Arrival get_row(partition::MessageReader& message) const;
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
