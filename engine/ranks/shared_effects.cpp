#include "engine/ranks/shared_effects.hpp"

#include "base/sort.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/ranks/rank_rows.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

}  // namespace

void SharedEffects::note_tree(BodyId body) {
  const std::vector<Row> tree = halo_.tree(world_.view().row(body));
  const unsigned owner = halo_.owner(body);
  for (const Row row : tree)
    affected_.push_back({world_.view().body(row), world_.view().body(tree.front()), tree.size() == 1, owner,
                         0, halo_.place(row)});
}

void SharedEffects::note() {
  affected_.clear();
  lacking_.clear();
  own_ = effects_.emitted().size();
  for (const Effect& effect : effects_.emitted()) {
    if (!effect.is_of_life()) note_tree(effect.source);
    if (effect.target.index() >= world_.spec().bodies.size()) continue;  // it has no target
    const RowLocation location = world_.view().location(effect.target);
    if (location == RowLocation::here && !effect.is_of_life()) note_tree(effect.target);
    if (location != RowLocation::elsewhere) continue;
    if (!acts_anywhere(effect))
      throw StepError(fmt::format(
          "tick {}: the device \"{}\" of \"{}\" acts on \"{}\", which is beyond the reach of the device "
          "(DeviceKind::Prepared::reach_m)",
          world_.tick(), world_.view().type(world_.view().row(effect.source)).devices[effect.device].name,
          world_.spec().name(effect.source), world_.spec().name(effect.target)));
    if (!effect.is_of_life()) lacking_.push_back(effect.target);
  }
  noted_ = affected_.size();
  own_lacking_ = lacking_.size();
}

void SharedEffects::put(MessageWriter& message) const {
  message.put_all(effects_.emitted().first(own_));
  if (own_ == 0) return;
  put_affected(message, std::span(affected_).first(noted_));
  message.put_all(std::span<const BodyId>(lacking_).first(own_lacking_));
}

void SharedEffects::get(MessageReader& message) {
  std::size_t effects = message.get_count(sizeof(Effect));
  if (effects == 0) return;
  for (; effects > 0; --effects) effects_.emit(get_effect(message, world_));
  get_affected(message);
  for (std::size_t bodies = message.get_count(sizeof(BodyId)); bodies > 0; --bodies)
    lacking_.push_back(message.get_below<BodyId>(world_.spec().bodies.size()));
}

void SharedEffects::put_affected(MessageWriter& message, std::span<const Affected> some) {
  message.put(static_cast<std::uint64_t>(some.size()));
  for (const Affected& each : some) {
    message.put(each.body);
    message.put(each.root);
    message.put(each.is_alone);
    message.put(each.owner);
    message.put_point(each.place);
  }
}

/// Reads what put_affected() has appended, and adds it to affected_.
void SharedEffects::get_affected(MessageReader& message) {
  const std::size_t end = world_.spec().bodies.size();
  for (std::size_t bodies = message.get_count(1); bodies > 0; --bodies) {
    Affected& each = affected_.emplace_back();
    each.body = message.get_below<BodyId>(end);
    each.root = message.get_below<BodyId>(end);
    each.is_alone = message.get<bool>();
    each.owner = message.get_below<unsigned>(post_.ranks);
    each.place = message.get_point();
  }
}

bool SharedEffects::find_targets() {
  unite();
  const bool lacks_targets = !lacking_.empty();
  if (lacks_targets) find_lacking();
  guests_.clear();
  for (const Effect& effect : effects_.emitted()) {
    if (!acts_anywhere(effect) || effect.is_of_life()) continue;
    const Affected* const target = find(effect.target);
    if (target)
      guests_.push_back({target->root, find(effect.source)->place});  // static bodies are everywhere
  }
  return lacks_targets;
}

/// Finds the owners of the bodies in lacking_.
void SharedEffects::find_lacking() {
  sort_unique(lacking_);
  // All ranks have the same list. The owners of these bodies know where they are.
  MessageWriter own = post_.begin(Order::effects);
  const std::size_t known = affected_.size();
  for (const BodyId body : lacking_)
    if (world_.view().location(body) == RowLocation::here && halo_.owner(body) == post_.rank) note_tree(body);
  put_affected(own, std::span(affected_).subspan(known));
  post_.send_to_all(std::move(own));
  post_.receive_from_all(Order::effects, [&](unsigned, MessageReader& message) { get_affected(message); });
  unite();
}

/// Sorts affected_ by ids, and leaves one element per body.
void SharedEffects::unite() {
  std::ranges::sort(affected_, {}, &Affected::body);
  const auto is_same = [](const Affected& a, const Affected& b) { return a.body == b.body; };
  affected_.erase(std::unique(affected_.begin(), affected_.end(), is_same), affected_.end());
}

bool SharedEffects::acts_anywhere(const Effect& effect) const {
  return world_.view().type(effect.source).devices[effect.device].kind->scope == ApplyScope::any_target;
}

void SharedEffects::begin(bool is_new) {
  for (Affected& each : affected_) {
    if (is_new) each.owner = halo_.owner_at(each.place);
    each.last = each.owner;
  }
  by_root_.resize(affected_.size());
  std::iota(by_root_.begin(), by_root_.end(), std::uint32_t{0});
  std::ranges::sort(by_root_, {}, [&](std::uint32_t i) { return std::pair(affected_[i].root.value, i); });
}

SharedEffects::Affected* SharedEffects::find(BodyId body) {
  const auto found = std::ranges::lower_bound(affected_, body, {}, &Affected::body);
  return found != affected_.end() && found->body == body ? &*found : nullptr;
}

/// Whether an effect may attach bodies to others, or release them.
bool SharedEffects::may_join_trees(const Effect& effect) const {
  return !effect.is_of_life() && world_.view().type(effect.source).devices[effect.device].kind->carries;
}

/// Finds the groups of the tick (groups_). Returns the trees whose rows must go to another rank, because the
/// trees of their group belong to several ranks.
std::vector<Halo::Gift> SharedEffects::find_groups(std::span<const Effect> effects) {
  groups_.clear();
  if (std::ranges::none_of(effects, [&](const Effect& effect) { return may_join_trees(effect); })) return {};
  std::vector<Affected> trees(affected_);  // one element per tree
  std::ranges::sort(trees, {}, &Affected::root);
  const auto is_same = [](const Affected& a, const Affected& b) { return a.root == b.root; };
  trees.erase(std::unique(trees.begin(), trees.end(), is_same), trees.end());
  const auto index_of = [&](const Affected& body) {
    return static_cast<std::size_t>(std::ranges::lower_bound(trees, body.root, {}, &Affected::root) -
                                    trees.begin());
  };
  // Each tree belongs to the group of the tree leads[index]. The lowest tree of a group leads itself.
  std::vector<std::size_t> leads(trees.size());
  std::iota(leads.begin(), leads.end(), std::size_t{0});
  const auto lead_of = [&](std::size_t tree) {
    while (leads[tree] != tree) tree = leads[tree] = leads[leads[tree]];
    return tree;
  };
  for (const Effect& effect : effects) {
    if (effect.is_of_life()) continue;
    const Affected* const target = find(effect.target);
    if (!target) continue;
    const std::size_t a = lead_of(index_of(*find(effect.source)));
    const std::size_t b = lead_of(index_of(*target));
    leads[std::max(a, b)] = std::min(a, b);
  }
  std::vector<bool> may_join(trees.size());
  for (const Effect& effect : effects)
    if (may_join_trees(effect)) may_join[lead_of(index_of(*find(effect.source)))] = true;
  std::vector<Halo::Gift> gifts;
  for (std::size_t t = 0; t < trees.size(); ++t) {
    const Affected& lead = trees[lead_of(t)];
    if (!may_join[lead_of(t)]) continue;
    groups_.push_back({trees[t].root, lead.owner});
    if (trees[t].owner != lead.owner) gifts.push_back({trees[t].root, trees[t].owner, lead.owner});
  }
  return gifts;
}

/// The rank that applies the effects of the group of a tree; not set if the tree is in no group. root: the
/// root of the tree before the effects
std::optional<unsigned> SharedEffects::group_applier(BodyId root) const {
  const auto found = std::ranges::lower_bound(groups_, root, {}, &GroupTree::root);
  if (found == groups_.end() || found->root != root) return {};
  return found->applier;
}

/// The rank that applies the effects of the group of an effect; not set if the effect is in no group.
std::optional<unsigned> SharedEffects::group_applier(const Effect& effect) {
  if (groups_.empty()) return {};
  return group_applier(find(effect.source)->root);
}

void SharedEffects::apply(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply) {
  const std::vector<Halo::Gift> gifts = find_groups(effects);
  apply_in_turns(effects, apply);
  bool must_distribute = !gifts.empty();
  if (!groups_.empty()) {
    halo_.give(gifts);
    apply_groups(effects, apply);
    if (!must_distribute) must_distribute = post_.agree(Order::effects, !have_sufficed(), std::logical_or());
  }
  if (must_distribute)
    halo_.distribute(0);
  else
    show();
  error_.agree(post_);
}

/// Applies the effects of the groups that this rank applies.
void SharedEffects::apply_groups(std::span<const Effect> effects,
                                 const std::function<void(const Effect&)>& apply) {
  for (std::size_t i = 0; i < effects.size(); ++i)
    if (!effects[i].is_of_life() && group_applier(effects[i]) == post_.rank)
      error_.attempt(i, [&] { apply(effects[i]); });
}

/// After apply_groups(), if no tree has changed its owner: whether the ghosts of all ranks suffice for the
/// trees that this rank has changed.
bool SharedEffects::have_sufficed() const {
  return std::ranges::all_of(affected_, [&](const Affected& each) {
    return group_applier(each.root) != post_.rank || halo_.suffices_for(world_.view().row(each.body));
  });
}

/// Applies the effects that are in no group.
void SharedEffects::apply_in_turns(std::span<const Effect> effects,
                                   const std::function<void(const Effect&)>& apply) {
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (effects[i].is_of_life() || group_applier(effects[i]))
      continue;  // World::resolve_lives() does the former
    const Affected& source = *find(effects[i].source);
    bring_tree(source, source.owner);
    if (const Affected* const target = find(effects[i].target)) bring_tree(*target, source.owner);
    if (source.owner == post_.rank) error_.attempt(i, [&] { apply(effects[i]); });
  }
  for (Affected& each : affected_) bring(each, each.owner);
}

/// Calls bring() for all bodies of the tree of a body, in the order of their ids.
void SharedEffects::bring_tree(const Affected& body, unsigned to) {
  if (body.is_alone) return bring(*find(body.body), to);
  const auto root_of = [&](std::uint32_t i) { return affected_[i].root.value; };
  const auto first = std::ranges::lower_bound(by_root_, body.root.value, {}, root_of);
  for (auto i = first; i != by_root_.end() && root_of(*i) == body.root.value; ++i) bring(affected_[*i], to);
}

/// Makes `to` the rank that has the present state of a body (Affected::last). If another rank has it so far,
/// that rank sends the state to `to`. All ranks call this, but only these two exchange a message.
void SharedEffects::bring(Affected& body, unsigned to) {
  const unsigned from = std::exchange(body.last, to);
  if (from == to) return;
  const bool is_here = world_.view().location(body.body) == RowLocation::here;
  if (from == post_.rank) {
    MessageWriter message = post_.begin(Order::effects);
    if (is_here) halo_.put_state(message, body.body);
    post_.send(to, std::move(message));
  } else if (to == post_.rank) {
    // Both ranks have a row of the body, unless a device acts beyond its reach. Applying its effect then
    // throws.
    ReceivedOrder received = post_.receive(Order::effects, from);
    if (is_here && !received.rest.is_done()) halo_.get_state(received.rest, body.body);
  }
}

/// Sends the states of affected bodies whose rows this rank owns to the ranks that have these bodies as
/// ghosts. Receives the states of affected bodies that are ghosts on this rank, and links their trees again.
void SharedEffects::show() {
  for (unsigned to = 0; to < post_.ranks; ++to) {
    std::optional<MessageWriter> message;
    for (const BodyId body : halo_.shown(to)) {
      if (find(body) == nullptr) continue;
      if (!message) message = post_.begin(Order::effects);
      halo_.put_state(*message, body);
    }
    if (message) post_.send(to, *std::move(message));
  }
  std::vector<Row> in_groups;
  for (unsigned from = 0; from < post_.ranks; ++from) {
    std::optional<ReceivedOrder> received;
    for (const BodyId body : halo_.seen(from)) {
      const Affected* const affected = find(body);
      if (affected == nullptr) continue;
      if (!received) received = post_.receive(Order::effects, from);
      halo_.get_state(received->rest, body);
      if (group_applier(affected->root)) in_groups.push_back(world_.view().row(body));
    }
  }
  if (!in_groups.empty()) halo_.link_again(in_groups);
}

}  // namespace troupe::engine
