#include "engine/events.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace troupe::engine {

std::span<const EventKind> event_kinds() {
  using enum EventType;
  static constexpr std::array<EventKind, 6> kinds{{
      {stall_ends, "stall_ends", "the robot moved, or was not asked to, after its motions had been refused"},
      {held_ends, "held_ends", "the robot moved, or was not asked to, after it had been held at the bounds"},
      {stall_begins, "stall_begins", "the robot's motion was refused: something stood in its way"},
      {held_begins, "held_begins", "the robot's motion would have left the world: it was held at the bounds"},
      {birth, "birth", "the body of a reserve was born, here"},
      {death, "death", "the body died, here"},
  }};
  return kinds;
}

std::string_view event_name(EventType type) { return event_kinds()[static_cast<std::size_t>(type)].name; }

EventWatch::EventWatch(const World& world) { remember(world); }

EventWatch::Stall EventWatch::stall_of(const World& world, Row row) {
  if (!world.stalled(row)) return k_free;
  return world.held(row) ? k_held : k_refused;
}

void EventWatch::remember(const World& world) {
  tick_ = world.tick();
  stalls_.resize(world.rows());
  for (std::size_t r = 0; r < world.rows(); ++r) stalls_[r] = stall_of(world, Row(r));
  if (!world.has_lives()) return;
  lives_.resize(world.rows());
  for (std::size_t r = 0; r < world.rows(); ++r) lives_[r] = world.presence(Row(r));
}

void EventWatch::see_lives(const World& world) {
  for (std::size_t r = 0; r < lives_.size(); ++r) {
    const Presence now = world.presence(Row(r));
    if (now == lives_[r]) continue;
    if (now == Presence::dead && lives_[r] == Presence::unborn)
      events_.push_back({EventType::birth, world.body(Row(r))});
    events_.push_back(
        {now == Presence::dead ? EventType::death : EventType::birth, world.body(Row(r))});
    lives_[r] = now;
  }
}

std::span<const Event> EventWatch::see(const World& world) {
  events_.clear();
  if (world.tick() != tick_ + 1) {
    remember(world);
    return events_;
  }
  tick_ = world.tick();
  for (std::size_t r = 0; r < world.rows(); ++r) {
    const Stall now = stall_of(world, Row(r));
    if (now == stalls_[r]) continue;
    const BodyId body = world.body(Row(r));
    if (stalls_[r] != k_free)
      events_.push_back({stalls_[r] == k_held ? EventType::held_ends : EventType::stall_ends, body});
    if (now != k_free)
      events_.push_back({now == k_held ? EventType::held_begins : EventType::stall_begins, body});
    stalls_[r] = now;
  }
  see_lives(world);
  std::ranges::sort(events_, {}, [](const Event& event) { return std::tuple(event.body, event.type); });
  return events_;
}

}  // namespace troupe::engine
