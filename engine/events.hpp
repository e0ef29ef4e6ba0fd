#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// The types of events, in the order in which one robot's events of one tick are listed.
enum class EventType : std::uint8_t {
  stall_ends,    ///< the motion of the robot was blocked in the tick before, but not in this tick
  held_ends,     ///< the robot's motion was out of bounds in the tick before, but not in this tick
  stall_begins,  ///< the motion of the robot was blocked in this tick, but not in the tick before
  held_begins,   ///< the robot's motion was out of bounds in this tick, but not in the tick before
  release,       ///< the robot stopped carrying another body
  grip,          ///< the robot began to carry another body
  birth,         ///< the body was born
  death,         ///< the body died
  fails,         ///< the robot was disabled, or a fault stopped it completely
  recovers,      ///< the robot is no longer disabled or stopped by a fault
};

/// Name and text of an event type in tables and recordings.
struct EventKind {
  EventType type;         ///< the event type, which is the index in event_kinds()
  std::string_view name;  ///< name in files and tables: "stall_begins"
  std::string_view text;  ///< description in one line, for `troupe describe`
};
/// All event kinds, in the order of EventType.
std::span<const EventKind> event_kinds();
std::string_view event_name(EventType type);  ///< name in files and tables: "stall_begins"

/// An event of a tick.
struct Event {
  EventType type;  ///< type of the event
  BodyId body;     ///< the body that the event concerns
  BodyId other;    ///< for `release` and `grip`: the other body; not valid() for other types
};

/// Finds the events of a tick by comparing the state after the tick with the state before. The object stores
/// the parts of the earlier state that it needs, so watching may begin at any tick.
class EventWatch {
 public:
  /// Starts from the present state of the world.
  explicit EventWatch(const World& world);

  /// Returns the events of the tick that has just ended, sorted by (Event::body, Event::type, Event::other).
  /// Call this after every step. If the tick does not follow that of the last call, as after a reset, the
  /// result is empty. The result is valid until the next call.
  std::span<const Event> see(const World& world);

 private:
  enum Stall : std::uint8_t { k_free, k_blocked, k_out_of_bounds };
  static Stall stall_of(const World& world, Row row);
  static BodyId carrier_of(const World& world, Row row);
  void see_lives(const World& world);
  void see_failures(const World& world);
  void remember(const World& world);

  std::uint64_t tick_ = 0;
  // One per body of the world; those of static bodies are unused.
  std::vector<Stall> stalls_;
  std::vector<BodyId> carriers_;  // invalid: it is not carried
  std::vector<Presence> lives_;   // empty if the world has no births and deaths
  std::vector<bool> disabled_;    // empty if the world has no faults and disables no bodies
  std::vector<Event> events_;
};

}  // namespace troupe::engine
