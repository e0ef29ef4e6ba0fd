#pragma once

#include "engine/world/world.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// The types of events, in the order in which the events of one body in one tick (time step) are listed. A
/// robot is a body with a drive. "Blocked" means that another body, which may be a static one such as a wall,
/// was in the way of the robot's motion; "out of bounds" means that the motion would have ended outside the
/// bounds of the world. In both cases the robot stays in place.
enum class EventType : std::uint8_t {
  /// the motion of the robot was blocked in the tick before, but not in this tick; also if the robot has died
  stall_ends,
  /// the motion of the robot was out of bounds in the tick before, but not in this tick; also if the robot
  /// has died
  held_ends,
  stall_begins,  ///< the motion of the robot was blocked in this tick, but not in the tick before
  held_begins,   ///< the robot's motion was out of bounds in this tick, but not in the tick before
  release,       ///< the robot stopped carrying another body (Event::other)
  grip,          ///< the robot began to carry another body (Event::other)
  birth,         ///< the body was born, and so entered the world
  death,         ///< the body died, and so left the world
  /// the robot was disabled (by an intervention of the world file or by a program), or a drop-out fault (a
  /// random failure) occurred; in both cases its devices, controllers and drive stop. No event if the robot
  /// had already been stopped in one of these two ways
  fails,
  recovers,  ///< the robot is in the world, and no longer disabled or stopped by a drop-out fault
};

/// Name and text of an event type in tables and recordings. Both have static storage.
struct EventKind {
  EventType type;         ///< the event type; as a number, its index in event_kinds()
  std::string_view name;  ///< name in files and tables: "stall_begins"
  std::string_view text;  ///< description in one line, for `troupe describe`
};
/// All event kinds, in the order of EventType. The list has static storage.
std::span<const EventKind> event_kinds();
std::string_view event_name(EventType type);  ///< name in files and tables: "stall_begins"

/// An event of a tick.
struct Event {
  EventType type;  ///< type of the event
  BodyId body;     ///< the body that the event concerns; for `release` and `grip`, the carrier
  BodyId other;    ///< for `release` and `grip`: the carried body; not valid() for other types
};

/// Finds the events of a tick by comparing the state of a world after the tick with the state before. The
/// object stores the parts of the earlier state that it needs, so watching may begin at any tick. Each object
/// can watch only one world.
class EventWatch {
 public:
  /// Starts from the present state of the world: the first events are those of the next tick. The state must
  /// be complete: the last step must not have thrown an exception (World::require_whole()). The constructor
  /// does not check this.
  explicit EventWatch(const World& world);

  /// Returns the events of the tick that has just ended, sorted by (Event::body, Event::type, Event::other).
  /// Changes that a program made to the world since the last call, such as disabling a robot, are included.
  /// Call this after every step. The result is empty if the world has not advanced by exactly one tick since
  /// the last call (before the first call: since construction), for example after a reset. A body that was
  /// born and died in one tick has both events. The result is valid until the next call. Throws
  /// std::logic_error if the last step threw (World::require_whole()).
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
