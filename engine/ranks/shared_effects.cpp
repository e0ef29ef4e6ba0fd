#include "engine/ranks/shared_effects.hpp"

#include "engine/kinds/step_error.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

}  // namespace

void SharedEffects::note(BodyId body) {
  affected_.push_back({body, halo_.owner(body), 0, world_.transform(world_.row(body)).position});
}

void SharedEffects::note() {
  affected_.clear();
  lacking_.clear();
  own_ = effects_.emitted().size();
  for (const Effect& effect : effects_.emitted()) {
    if (!effect.is_of_life()) note(effect.source);
    if (effect.target.index() >= world_.spec().bodies.size()) continue;  // it has no target
    const RowLocation location = world_.location(effect.target);
    if (location == RowLocation::here && !effect.is_of_life()) note(effect.target);
    if (location != RowLocation::elsewhere) continue;
    if (!acts_anywhere(effect))
      throw StepError(fmt::format(
          "tick {}: the device \"{}\" of \"{}\" acts on \"{}\", which is beyond the reach of the device "
          "(DeviceKind::Prepared::reach_m)",
          world_.tick(), world_.type(world_.row(effect.source)).devices[effect.device].name,
          world_.spec().name(effect.source), world_.spec().name(effect.target)));
    if (!effect.is_of_life()) lacking_.push_back(effect.target);
  }
  noted_ = affected_.size();
  own_lacking_ = lacking_.size();
}

void SharedEffects::put(MessageWriter& message) const {
  message.put(static_cast<std::uint64_t>(own_));
  message.put_bytes(std::as_bytes(effects_.emitted().first(own_)));
  if (own_ == 0) return;
  put_affected(message, std::span(affected_).first(noted_));
  message.put(static_cast<std::uint64_t>(own_lacking_));
  message.put_bytes(std::as_bytes(std::span(lacking_).first(own_lacking_)));
}

void SharedEffects::get(MessageReader& message) {
  auto effects = message.get<std::uint64_t>();
  if (effects == 0) return;
  for (; effects > 0; --effects) effects_.emit(message.get<Effect>());
  get_affected(message);
  for (auto bodies = message.get<std::uint64_t>(); bodies > 0; --bodies)
    lacking_.push_back(message.get<BodyId>());
}

void SharedEffects::put_affected(MessageWriter& message, std::span<const Affected> some) {
  message.put(static_cast<std::uint64_t>(some.size()));
  for (const Affected& each : some) {
    message.put(each.body);
    message.put(each.owner);
    message.put_point(each.position);
  }
}

/// Reads what put_affected() has appended, and adds it to affected_.
void SharedEffects::get_affected(MessageReader& message) {
  for (auto bodies = message.get<std::uint64_t>(); bodies > 0; --bodies) {
    Affected& each = affected_.emplace_back();
    each.body = message.get<BodyId>();
    each.owner = message.get<unsigned>();
    each.position = message.get_point();
  }
}

bool SharedEffects::find_targets() {
  unite();
  guests_.clear();
  for (const Effect& effect : effects_.emitted()) {
    if (!acts_anywhere(effect) || effect.is_of_life()) continue;
    if (effect.target.index() >= world_.spec().bodies.size()) continue;  // it has no target
    if (world_.location(effect.target) == RowLocation::none) continue;   // all ranks have static bodies
    guests_.push_back({effect.target, find(effect.source)->position});
  }
  if (lacking_.empty()) return false;
  std::ranges::sort(lacking_);
  lacking_.erase(std::unique(lacking_.begin(), lacking_.end()), lacking_.end());
  // All ranks have the same list. The owners of these bodies know where they are.
  MessageWriter own = post_.begin(Order::effects);
  const std::size_t known = affected_.size();
  for (const BodyId body : lacking_)
    if (world_.location(body) == RowLocation::here && halo_.owner(body) == post_.rank) note(body);
  put_affected(own, std::span(affected_).subspan(known));
  post_.send_to_all(std::move(own));
  for (unsigned from = 0; from < post_.ranks; ++from) {
    if (from == post_.rank) continue;
    ReceivedOrder received = post_.receive(Order::effects, from);
    get_affected(received.rest);
  }
  unite();
  return true;
}

/// Sorts affected_ by ids, and leaves one element per body.
void SharedEffects::unite() {
  std::ranges::sort(affected_, {}, [](const Affected& each) { return each.body.value; });
  const auto is_same = [](const Affected& a, const Affected& b) { return a.body == b.body; };
  affected_.erase(std::unique(affected_.begin(), affected_.end(), is_same), affected_.end());
}

bool SharedEffects::acts_anywhere(const Effect& effect) const {
  return world_.type(effect.source).devices[effect.device].kind->scope == ApplyScope::any_target;
}

void SharedEffects::begin(bool is_new) {
  for (Affected& each : affected_) {
    if (is_new) each.owner = halo_.owner_at(each.position);
    each.last = each.owner;
  }
}

SharedEffects::Affected* SharedEffects::find(BodyId body) {
  const auto found = std::ranges::lower_bound(affected_, body.value, {},
                                              [](const Affected& each) { return each.body.value; });
  return found != affected_.end() && found->body == body ? &*found : nullptr;
}

void SharedEffects::apply(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply) {
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (effects[i].is_of_life()) continue;  // World::resolve_lives() carries it out
    Affected& source = *find(effects[i].source);
    bring(source, source.owner);
    if (Affected* const target = find(effects[i].target)) bring(*target, source.owner);
    if (source.owner == post_.rank) error_.attempt(i, [&] { apply(effects[i]); });
  }
  for (Affected& each : affected_) bring(each, each.owner);
  show();
  error_.agree(post_);
}

/// Makes `to` the rank that has the present state of a body (Affected::last). If another rank has it so far,
/// that rank sends the state to `to`. All ranks call this, but only these two exchange a message.
void SharedEffects::bring(Affected& body, unsigned to) {
  const unsigned from = std::exchange(body.last, to);
  if (from == to) return;
  const bool is_here = world_.location(body.body) == RowLocation::here;
  if (from == post_.rank) {
    MessageWriter message = post_.begin(Order::effects);
    if (is_here) halo_.put_state(message, body.body);
    post_.send(to, std::make_shared<const partition::Message>(message.take()));
  } else if (to == post_.rank) {
    // Both ranks have a row of the body, unless a device acts beyond its reach. Applying its effect then
    // throws.
    ReceivedOrder received = post_.receive(Order::effects, from);
    if (is_here && !received.rest.is_done()) halo_.get_state(received.rest, body.body);
  }
}

/// Sends the states of affected bodies whose rows this rank owns to the ranks that have these bodies as
/// ghosts. Receives the states of affected bodies that are ghosts on this rank.
void SharedEffects::show() {
  for (unsigned to = 0; to < post_.ranks; ++to) {
    std::optional<MessageWriter> message;
    for (const BodyId body : halo_.shown(to)) {
      if (find(body) == nullptr) continue;
      if (!message) message = post_.begin(Order::effects);
      halo_.put_state(*message, body);
    }
    if (message) post_.send(to, std::make_shared<const partition::Message>(message->take()));
  }
  for (unsigned from = 0; from < post_.ranks; ++from) {
    std::optional<ReceivedOrder> received;
    for (const BodyId body : halo_.seen(from)) {
      if (find(body) == nullptr) continue;
      if (!received) received = post_.receive(Order::effects, from);
      halo_.get_state(received->rest, body);
    }
  }
}

}  // namespace troupe::engine
