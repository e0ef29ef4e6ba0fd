#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// What may happen to a robot, and what it may do to others.
enum class EventType : std::uint8_t {
  stall_ends,    ///< its motions are no longer refused
  held_ends,     ///< it no longer wants to leave the world
  stall_begins,  ///< something stands in its way
  held_begins,   ///< it would have left the world
  release,       ///< it has let go of another body
  grip,          ///< it has taken hold of another body
  birth,         ///< its life begins
  death,         ///< its life is over
  fails,         ///< all of it has stopped
  recovers,      ///< it works again
};

/// What tables and recordings call an event.
struct EventKind {
  EventType type;         ///< its place in event_kinds()
  std::string_view name;  ///< "stall_begins"
  std::string_view text;  ///< one line for people
};
/// All of them, in the order in which one robot's events of one tick are told: the order of EventType.
std::span<const EventKind> event_kinds();
std::string_view event_name(EventType type);  ///< its name

/// Something that happened in a tick.
struct Event {
  EventType type;  ///< what
  BodyId body;     ///< to whom, or who did it
  BodyId other;    ///< what it let go of, or took hold of; not valid of the rest
};

/// Finds what happened in a tick from two states that follow one another: it remembers nothing that is not in
/// the first, so that it may begin with any.
class EventWatch {
 public:
  /// Begins with the state that the world is in.
  explicit EventWatch(const World& world);

  /// The events of the tick that has just ended, by id, type and the other's id. To be called after every
  /// step; of a tick that does not follow the last one (after a reset) nothing is told. Valid until the next
  /// call.
  std::span<const Event> see(const World& world);

 private:
  enum Stall : std::uint8_t { k_free, k_refused, k_held };
  static Stall stall_of(const World& world, Row row);
  static BodyId carrier_of(const World& world, Row row);
  void see_lives(const World& world);
  void see_failures(const World& world);
  void remember(const World& world);

  std::uint64_t tick_ = 0;
  std::vector<Stall> stalls_;     // a row each
  std::vector<BodyId> carriers_;  // a row each; not valid: it is not carried
  std::vector<Presence> lives_;   // a row each; empty where no body is born or dies
  std::vector<bool> outs_;        // a row each; empty where no robot fails
  std::vector<Event> events_;
};

}  // namespace troupe::engine
