#include "engine/observing/events.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace troupe::engine {

std::span<const EventKind> event_kinds() {
  using enum EventType;
  static constexpr std::array<EventKind, 10> kinds{{
      {stall_ends, "stall_ends",
       "the motion of the robot was blocked in the tick before; in this tick, it was not blocked, or there "
       "was no motion"},
      {held_ends, "held_ends",
       "the motion of the robot would have left the bounds of the world in the tick before; in this tick, it "
       "would not, or there was no motion"},
      {stall_begins, "stall_begins",
       "the motion of the robot was blocked by a body or a wall in this tick, but not in the tick before"},
      {held_begins, "held_begins",
       "the motion of the robot would have left the bounds of the world in this tick, but not in the tick "
       "before; the robot stayed in place"},
      {release, "release", "the robot released a body that it carried"},
      {grip, "grip", "the robot gripped a body, and carries it from now on"},
      {birth, "birth", "a body from the reserve of its population entered the world at this pose"},
      {death, "death", "the body died at this pose"},
      {fails, "fails",
       "the devices, controllers and drive of the robot stopped: it was disabled, or a drop_out fault "
       "occurred"},
      {recovers, "recovers", "the robot works again after an event `fails`"},
  }};
  return kinds;
}

std::string_view event_name(EventType type) { return event_kinds()[static_cast<std::size_t>(type)].name; }

EventWatch::EventWatch(World& world) {
  world.watch_contacts();
  remember(world);
}

EventWatch::Stall EventWatch::stall_of(const World& world, Row row) {
  if (!world.view().stalled(row)) return k_free;
  return world.view().is_out_of_bounds(row) ? k_out_of_bounds : k_blocked;
}

BodyId EventWatch::carrier_of(const World& world, Row row) {
  return world.view().carrier(row).value_or(BodyId());
}

void EventWatch::remember(const World& world) {
  tick_ = world.tick();
  const std::size_t bodies = world.spec().bodies.size();
  stalls_.resize(bodies);
  carriers_.resize(bodies);
  if (world.view().has_conditions()) disabled_.resize(bodies);
  if (world.view().has_lives()) lives_.resize(bodies);
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const std::size_t b = world.view().body(Row(r)).index();
    stalls_[b] = stall_of(world, Row(r));
    carriers_[b] = carrier_of(world, Row(r));
    if (!disabled_.empty()) disabled_[b] = world.view().is_disabled(Row(r));
    if (!lives_.empty()) lives_[b] = world.view().presence(Row(r));
  }
}

/// Adds an event `fails` or `recovers` for each robot that stopped or resumed working since the tick before.
/// Bodies that are not in the world have no such events.
void EventWatch::see_failures(const World& world) {
  if (disabled_.empty()) return;
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const BodyId body = world.view().body(Row(r));
    const bool now = world.view().is_disabled(Row(r));
    if (now == disabled_[body.index()]) continue;
    if (world.view().is_there(Row(r)))
      events_.push_back({now ? EventType::fails : EventType::recovers, body, {}});
    disabled_[body.index()] = now;
  }
}

void EventWatch::see_lives(const World& world) {
  if (lives_.empty()) return;
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const BodyId body = world.view().body(Row(r));
    const Presence now = world.view().presence(Row(r));
    Presence& before = lives_[body.index()];
    if (now == before) continue;
    if (now == Presence::dead && before == Presence::unborn) events_.push_back({EventType::birth, body, {}});
    events_.push_back({now == Presence::dead ? EventType::death : EventType::birth, body, {}});
    before = now;
  }
}

std::span<const Event> EventWatch::see(const World& world) {
  world.require_whole();
  events_.clear();
  if (world.tick() != tick_ + 1) {
    remember(world);
    return events_;
  }
  tick_ = world.tick();
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const BodyId body = world.view().body(Row(r));
    Stall& before = stalls_[body.index()];
    if (const Stall now = stall_of(world, Row(r)); now != before) {
      if (before != k_free)
        events_.push_back(
            {before == k_out_of_bounds ? EventType::held_ends : EventType::stall_ends, body, {}});
      if (now != k_free)
        events_.push_back({now == k_out_of_bounds ? EventType::held_begins : EventType::stall_begins, body,
                           world.view().contact(Row(r)).blocker()});
      before = now;
    }
    BodyId& carrier = carriers_[body.index()];
    if (const BodyId now = carrier_of(world, Row(r)); now != carrier) {
      if (carrier.valid()) events_.push_back({EventType::release, carrier, body});
      if (now.valid()) events_.push_back({EventType::grip, now, body});
      carrier = now;
    }
  }
  see_lives(world);
  see_failures(world);
  std::ranges::sort(events_, {},
                    [](const Event& event) { return std::tuple(event.body, event.type, event.other); });
  return events_;
}

}  // namespace troupe::engine
