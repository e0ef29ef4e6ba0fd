#pragma once

#include "base/pose.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

// A component is one table of the state, with a row for each body that has these data. These structs are the
// rows of components that the engine itself defines.

/// Names of the components that the engine itself defines, sorted. The components of a joint NAME are called
/// `joint/NAME`. No device or controller kind may have one of these names (worldio::check_kind_name()): in
/// checkpoints and recordings, the components of a kind are in a group that has the name of the kind.
inline constexpr std::array<std::string_view, 9> k_engine_components{
    "carrier", "command", "condition", "joint", "life", "odometry", "pose", "stall", "velocity"};

/// A row of the component `carrier`: which body carries the row's body, and where. All members are zero if
/// the body is not carried.
struct Carried {
  std::uint32_t carrier = 0;  ///< id of the carrier plus 1; 0: the body is not carried
  std::uint32_t joint = 0;    ///< index of the carrier's joint that holds the body, plus 1; 0: none
  /// Pose of the carried body, m and rad, in the body frame of the carrier. If `joint` is not 0, the carried
  /// body moves with that joint, and `pose` is the pose that the body would have with the joint at rest.
  Pose pose;
};

/// Whether a body is in the world.
enum class Presence : std::uint8_t {
  there,   ///< in the world
  unborn,  ///< not yet in the world: waits in a reserve (ReserveSpec), and may be born later
  dead,    ///< died, and never comes back
};

/// A row of the component `life`: whether a body is in the world, and when and where it was born. All members
/// are zero while a body that was present at tick 0 is in the world. At the death of any body, only
/// `presence` changes.
struct Life {
  /// Number of ticks that were completed when the body was born; 0 if it was present at tick 0 or is unborn.
  std::uint64_t birth = 0;
  /// x of the body's position at birth, m, world frame; 0 if it was present at tick 0 or is unborn.
  double x = 0;
  /// y of the body's position at birth, m, world frame; 0 if it was present at tick 0 or is unborn.
  double y = 0;
  std::uint8_t presence = 0;  ///< whether the body is in the world: a value of Presence
};

/// The impairments of a body (it is disabled, or faults have occurred): a row of the component `condition`.
/// All members are zero for an unimpaired body, and for a body that is not in the world.
struct Condition {
  /// The reasons why all devices, controllers and the drive of a body are stopped; both may apply.
  enum Out : std::uint8_t {
    k_disabled = 1,  ///< disabled by an intervention, a program or a user, until it is enabled again
    /// A drop-out fault stopped it. The end of any drop-out of the body clears this bit, even if another
    /// drop-out of the body still lasts.
    k_dropped_out = 2,
  };
  /// Factor by which faults scale the velocity that the drive of the body produces, above 0 and at most 1; 0:
  /// no fault has changed the velocity.
  double speed = 0;
  /// Devices that faults have broken: bit d for device d of the type (BodyType::devices). Devices with an
  /// index of 32 or more cannot break.
  std::uint32_t dead = 0;
  std::uint8_t out = 0;  ///< bits of Out; each alone stops devices, controllers and drive

  /// Whether the body is unimpaired.
  bool is_sound() const { return speed == 0 && dead == 0 && out == 0; }
};

}  // namespace troupe::engine
