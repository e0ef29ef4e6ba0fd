#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/ranks/halo.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/shared_error.hpp"
#include "partition/message.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace troupe::engine {

/// Applies the effects of a tick (a time step) in a world whose rows are distributed among ranks. Ranks are
/// threads or processes that compute a world together.
///
/// A *row* is the data of one body in the state tables. Each rank has the rows that it owns, and *ghosts*:
/// copies of rows that other ranks own (class Halo). An *effect* is an action of a device on another body.
/// The *source* of an effect is the body of the device, and the *target* is the other body. A *tree* is a
/// body that is not carried (the root of the tree), together with all bodies that it carries, directly or
/// through others. All rows of a tree have the same owner.
///
/// turns   Every rank knows all effects of the tick, and which rank owns each source and each target. All
///         ranks go through the effects in one order, so each rank knows which messages to send and which to
///         expect. The rank that owns the source of an effect applies the effect. Before that, other ranks
///         may have changed states of bodies in the tree of the source or in the tree of the target. They
///         send these states to the applying rank first. Each effect thus sees the results of the earlier
///         effects.
/// groups  Devices that can carry bodies (DeviceKind::carries) may attach and release bodies, and so change
///         trees during the tick. The effects on trees that may change in this way are not applied in turns,
///         but group by group. An effect connects the tree of its source and the tree of its target.
///         Connected trees form a *group* if at least one of their effects comes from a device that can carry
///         bodies. One rank applies all effects of a group, after all effects that belong to no group. If
///         several ranks own trees of the group, this rank must first become the owner of all of them
///         (Halo::give()).
/// end     After the last effect, the rows are distributed again if a tree has a new owner, or if the ghosts
///         of any rank do not suffice for the changed trees of groups (Halo::suffices_for()). Otherwise, each
///         owner gets back the states of its bodies, and sends them to the ranks that have ghosts of these
///         bodies.
/// guests  The owner of the source needs the row of the target. The *reach* of a device is a radius around
///         its body (DeviceKind::Prepared::reach_m). A rank has the rows of all bodies within the reach of
///         its devices, as own rows or as ghosts. A device of the scope ApplyScope::any_target can act on
///         bodies beyond its reach. If a rank lacks the row of such a target, the ranks distribute the rows
///         again before any body moves. The rank then gets a copy of the row (Halo::Guest).
/// lives   Births and deaths are effects too. This class only makes them known to all ranks. Later in the
///         tick, every rank carries them out (World::resolve_lives()).
///
/// Worlds with devices that can change any body (ApplyScope::anything) are not distributed
/// (why_replicated()).
class SharedEffects {
 public:
  /// `world`, `halo` and `effects` must outlive this object.
  ///
  /// effects: the list to which the devices of `world` add their effects; get() adds the effects of other
  /// ranks
  /// post: sends and receives the messages of this rank
  SharedEffects(World& world, Halo& halo, Effects& effects, RankPost post)
      : world_(world), halo_(halo), effects_(effects), post_(std::move(post)) {}

  /// Notes the effects that devices on this rank have emitted in this tick. Called on all ranks after the
  /// phase decide, in which the controllers compute commands. Throws StepError if this rank lacks the row of
  /// a target, because the target is then beyond the reach of the device. For devices of the scope
  /// ApplyScope::any_target, the function does not throw: find_targets() handles the missing rows.
  void note();
  /// Appends the effects that note() has noted.
  void put(partition::MessageWriter& message) const;
  /// Reads the effects that put() has appended on another rank, and adds them to the list `effects` of the
  /// constructor.
  void get(partition::MessageReader& message);
  /// Called on all ranks after get() has read the effects of all other ranks: finds the owners of missing
  /// targets. A target is missing if the rank that owns the source of the effect lacks the row of the target.
  /// Returns whether there are missing targets. If so, the caller must distribute the rows and pass guests()
  /// (Halo::prepare_motions()).
  bool find_targets();
  /// The targets that may be beyond the reach of a device: one entry for each effect of a device of the scope
  /// ApplyScope::any_target, except births, deaths, and effects on static bodies. The list is the same on all
  /// ranks, and valid after find_targets().
  std::span<const Halo::Guest> guests() const { return guests_; }
  /// Notes which rank owns each body in the trees of the sources and targets. Called on all ranks after
  /// find_targets() and Halo::prepare_motions(), before any body moves. From this call until apply(), no row
  /// may change its owner.
  ///
  /// is_new: whether the rows have been distributed since note()
  void begin(bool is_new);
  /// Applies the effects of all ranks, except births and deaths. Called on all ranks after bodies have moved.
  ///
  /// effects: the effects of all ranks, in the order of Effects::sorted(); the same on all ranks
  /// apply: applies one effect; called for each effect on one rank only. If a call throws on any rank, this
  /// function throws on all ranks: the exception itself on that rank, and a StepError on the others. If
  /// several calls throw, only the first exception in the order of `effects` counts.
  void apply(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply);

 private:
  struct Affected {  // a body of the tree of a source or of a target
    BodyId body;
    BodyId root;                // root of its tree
    bool is_alone = true;       // no other body is in the tree
    unsigned owner = 0;         // the rank that owns its row
    unsigned last = 0;          // the rank that has its present state
    Vec2 place = Vec2::Zero();  // Halo::place() before the motion of this tick, m, world frame
  };
  struct GroupTree {  // a tree of a group
    BodyId root;
    unsigned applier = 0;  // the rank that applies the effects of the group
  };
  void note_tree(BodyId body);
  static void put_affected(partition::MessageWriter& message, std::span<const Affected> some);
  void get_affected(partition::MessageReader& message);
  void find_lacking();
  void unite();
  bool acts_anywhere(const Effect& effect) const;
  bool may_join_trees(const Effect& effect) const;
  std::vector<Halo::Gift> find_groups(std::span<const Effect> effects);
  void apply_groups(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply);
  bool have_sufficed() const;
  std::optional<unsigned> group_applier(BodyId root) const;
  std::optional<unsigned> group_applier(const Effect& effect);
  void apply_in_turns(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply);
  Affected* find(BodyId body);
  void bring_tree(const Affected& body, unsigned to);
  void bring(Affected& body, unsigned to);
  void show();

  World& world_;
  Halo& halo_;
  Effects& effects_;
  RankPost post_;
  std::size_t own_ = 0;    // number of the noted effects, which come first in effects_
  std::size_t noted_ = 0;  // number of elements of affected_ after note()
  SharedError error_;
  // After note(): bodies of trees that own effects affect. After find_targets(): of trees that the effects of
  // all ranks affect, in order of ids.
  std::vector<Affected> affected_;
  std::vector<std::uint32_t> by_root_;  // after begin(): indices in affected_, by roots, then by ids
  // Targets whose rows are not on the rank of their source: own_lacking_ of own effects, then of other ranks.
  std::vector<BodyId> lacking_;
  std::size_t own_lacking_ = 0;
  std::vector<Halo::Guest> guests_;  // guests()
  std::vector<GroupTree> groups_;    // in the order of roots
};

}  // namespace troupe::engine
