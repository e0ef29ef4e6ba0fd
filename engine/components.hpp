#pragma once

#include "base/pose.hpp"

#include <cstdint>

namespace troupe::engine {

// A component is one table of the state, with a row for each body that has these data. These structs are the
// rows of the components that the engine itself defines. Kinds define all other components.

/// A row of the component `carrier`: all zero if the body is not carried.
struct Carried {
  std::uint32_t carrier = 0;  ///< id of the carrier plus 1; 0: the body is not carried
  std::uint32_t joint = 0;    ///< index of the carrier's joint that holds the body, plus 1; 0: none
  /// Pose of the carried body, m and rad, in the frame of the carrier. If `joint` is not 0, that frame is
  /// displaced by the present motion of the joint from rest.
  Pose pose;
};

/// Whether a body is in the world.
enum class Presence : std::uint8_t {
  there,   ///< in the world
  unborn,  ///< waits in a reserve (ReserveSpec) and may be born later
  dead,    ///< died, and never comes back
};

/// A row of the component `life`: all zero for bodies present at tick 0.
struct Life {
  std::uint64_t birth = 0;    ///< number of ticks that were completed at its birth
  double x = 0;               ///< x at its birth, m, world frame
  double y = 0;               ///< y at its birth, m, world frame
  std::uint8_t presence = 0;  ///< whether the body is in the world, a Presence
};

/// The impairments of a body: a row of the component `condition`, all zero for an unimpaired body.
struct Condition {
  /// The reasons why all devices, controllers and the drive of a body are stopped; both may apply.
  enum Out : std::uint8_t {
    k_disabled = 1,     ///< an intervention or a program disabled it, until it is enabled again
    k_dropped_out = 2,  ///< a fault stopped it, until the fault ends
  };
  double speed = 0;        ///< factor on the velocity of its drive; 0: the velocity is not changed
  std::uint32_t dead = 0;  ///< devices that do not work: bit d for device d of the type
  std::uint8_t out = 0;    ///< bits of Out; any bit stops devices, controllers and drive

  /// Whether the body is unimpaired.
  bool is_sound() const { return speed == 0 && dead == 0 && out == 0; }
};

}  // namespace troupe::engine
