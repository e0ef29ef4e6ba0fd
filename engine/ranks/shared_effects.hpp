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

/// The effects of a tick, which is a time step, in a world whose rows are distributed among ranks. An effect
/// is an action of a device on another body. Its source is the body of the device, and its target the other
/// body. Ranks are threads or processes that compute a world together. A row is the data of one body in the
/// state tables. A rank has the rows that it owns and *ghosts*, copies of rows of other ranks (class Halo). A
/// *tree* is a body that is not carried (the root) with all bodies that it carries, directly or through
/// others. All effects of a tick are applied in one order, and each effect sees the results of the earlier
/// effects. The ranks therefore take turns: the rank that owns the source of an effect applies this effect.
/// If the last change of a body in the trees of the source and the target was made on another rank, that rank
/// sends the state of the body first. At the end, the other ranks get the new states of those affected bodies
/// that they own or have as ghosts.
///
/// Devices that can carry bodies (DeviceKind::carries) may attach bodies to others and release them. Such an
/// effect needs all changes that earlier effects of the tick have made to the trees of its source and its
/// target. Each effect connects the tree of its source to the tree of its target. Trees that are connected,
/// directly or through other trees, form a *group* if one of their effects could attach or release bodies.
/// One rank applies all effects of a group. This rank owns the trees of the group or, if they belong to
/// several ranks, gets them (Halo::give()) after all other effects of the tick. At the end all ranks
/// distribute the rows if trees have changed their owner, or if any rank lacks ghosts of the changed trees
/// (Halo::suffices_for()). Otherwise, the owners of the trees send the states of their bodies to the ranks
/// that have them as ghosts.
///
/// Births and deaths are effects too. They change no other state, so the ranks only learn of them here: every
/// rank then carries them out (World::resolve_lives()).
///
/// The rank that owns the source of an effect must have the row of the target. If the target is within the
/// reach of the device, the rank has it, as own row or ghost. A device of the scope ApplyScope::any_target
/// can act on bodies farther away. Its targets become guests of the rank (Halo::Guest): if a rank lacks the
/// row of such a target, the ranks distribute the rows again before any body moves, and the rank then gets a
/// copy.
///
/// All ranks know all effects of the tick, and which rank owns each source and target. Each rank therefore
/// knows which messages to send and which to expect. Worlds with devices that can change any bodies
/// (ApplyScope::anything) are not distributed (why_replicated()).
class SharedEffects {
 public:
  /// effects: those of `world`. World, halo and effects must outlive this object.
  SharedEffects(World& world, Halo& halo, Effects& effects, RankPost post)
      : world_(world), halo_(halo), effects_(effects), post_(std::move(post)) {}

  /// Called on all ranks after the controllers have decided (the phase decide): notes the effects that
  /// devices on this rank have emitted. If this rank lacks the row of a target, the target is beyond the
  /// reach that the device declares. The function then throws StepError, unless the scope of the device is
  /// ApplyScope::any_target.
  void note();
  /// Appends the noted effects.
  void put(partition::MessageWriter& message) const;
  /// Reads the effects that put() of another rank has appended, and adds them to the effects of the world.
  void get(partition::MessageReader& message);
  /// Called on all ranks when they know the effects of all ranks: finds the owners of the targets whose rows
  /// are not on the rank of their source. Returns whether there are such targets, so that the rows must be
  /// distributed.
  bool find_targets();
  /// The targets of the effects of devices that can act from any distance. The list is the same on all ranks,
  /// and valid after find_targets().
  std::span<const Halo::Guest> guests() const { return guests_; }
  /// Called after find_targets() and before any body moves: notes which rank owns each affected body. After
  /// this call, no row may change its owner before apply(). is_new: whether the rows were distributed since
  /// note()
  void begin(bool is_new);
  /// Applies `effects`, the effects of all ranks in their order, except births and deaths. `apply` applies
  /// one effect. If it throws on any rank, this function throws on all ranks: the exception itself on the
  /// rank where it was thrown, and a StepError on the others.
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
