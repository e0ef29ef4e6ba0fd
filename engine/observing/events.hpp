#pragma once

#include "engine/world/world.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// The types of events. The events of one body in one tick (time step) are listed in this order. A robot is a
/// body with a drive. The motion of a robot is "blocked" if another body is in its way, possibly a static
/// body such as a wall. It is "out of bounds" if it would end outside the bounds of the world. In both cases
/// the robot stays in place.
enum class EventType : std::uint8_t {
  /// the motion of the robot was blocked in the previous tick; in this tick it was not, or the robot did not
  /// move or has died
  stall_ends,
  /// the motion of the robot was out of bounds in the previous tick; in this tick it was not, or the robot
  /// did not move or has died
  held_ends,
  stall_begins,  ///< the motion of the robot was blocked in this tick, but not in the previous tick
  held_begins,   ///< the motion of the robot was out of bounds in this tick, but not in the previous one
  release,       ///< the robot stopped carrying another body (Event::other)
  grip,          ///< the robot began to carry another body (Event::other)
  birth,         ///< the body was born, and so entered the world
  death,         ///< the body died, and so left the world
  /// the robot was disabled (by an intervention of the world file or by a program), or a drop-out fault (a
  /// random failure) occurred. In both cases its devices, controllers and drive stop. There is no event if
  /// they had already stopped for one of these two reasons
  fails,
  recovers,  ///< no cause of `fails` remains: devices, controllers and drive of the robot work again
};

/// Name and description of an event type. Both texts have static storage.
struct EventKind {
  EventType type;         ///< the event type; as a number, its index in event_kinds()
  std::string_view name;  ///< name in files and tables: "stall_begins"
  std::string_view text;  ///< description in one line, for `troupe describe`
};
/// All event types with their names and descriptions, in the order of EventType. The list has static storage.
std::span<const EventKind> event_kinds();
std::string_view event_name(EventType type);  ///< name in files and tables: "stall_begins"

/// An event of a tick.
struct Event {
  EventType type;  ///< type of the event
  BodyId body;     ///< the body that the event concerns; for `release` and `grip`, the carrier
  /// For `release` and `grip`: the carried body. For `stall_begins`: the body that blocked the motion
  /// (Contact::body). Not valid() for other types.
  BodyId other;
};

/// Finds the events of each tick by comparing the state of a world after the tick with the state before it.
/// The object stores the parts of the earlier state that it needs, so watching may begin at any tick. An
/// object can watch only one world.
class EventWatch {
 public:
  /// Starts from the present state of the world: the first events are those of the next tick. Calls
  /// World::watch_contacts(). The last step
  /// of the world must not have thrown an exception, because its state is then incomplete
  /// (World::require_whole()). The constructor does not check this.
  explicit EventWatch(World& world);

  /// Returns the events of the tick that has just ended, sorted by (Event::body, Event::type, Event::other).
  /// Call this after every step. The result is valid until the next call.
  ///
  /// The events include changes that a program has made to the world since the last call, such as disabling a
  /// robot. A body that was born and died in one tick has both events. The result is empty if the world has
  /// not advanced by exactly one tick since the last call (before the first call: since construction), for
  /// example after a reset. Throws std::logic_error if the last step threw (World::require_whole()).
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
