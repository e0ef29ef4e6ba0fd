#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

// A component is one table of the state of a world, with a row for each body that has these data. These
// structs are the rows of components that the engine itself defines. Time advances in ticks, steps of equal
// length; tick 0 is the initial state.

/// Names of the components (tables of the state) that the engine itself defines, in alphabetical order.
/// `joint` stands for the components `joint/NAME`, one for each joint. A kind (an implementation of a device
/// or controller) must not have one of these names, because saved states and recordings store the components
/// of a kind in a group with its name. worldio::check_kind_name() checks this.
inline constexpr std::array<std::string_view, 10> k_engine_components{
    "carrier", "command", "condition", "contact", "joint", "life", "odometry", "pose", "stall", "velocity"};

/// Whether a text can be the name of a kind (a controller, device, drive, measure or fault) or of a plug-in:
/// one word without slash, colon, equals sign, quotation mark, backslash and white space, which does not
/// begin with a dot. Such a word cannot be mistaken for a path or for the parameters of a controller.
constexpr bool is_name(std::string_view name) {
  return !name.empty() && name.find_first_of("/:=\"\\ \t\n") == std::string_view::npos && name.front() != '.';
}

/// A row of the component (state table) `carrier`: which body carries the row's body, and where. All members
/// are zero if the body is not carried.
struct Carried {
  std::uint32_t carrier = 0;  ///< id of the carrier plus 1; 0: the body is not carried
  std::uint32_t joint = 0;    ///< index of the carrier's joint that holds the body, plus 1; 0: no joint
  /// Pose of the carried body, m and rad, in the body frame of the carrier. If `joint` is not 0, the carried
  /// body moves with that joint. `pose` is then the pose that the body would have if the joint were at rest.
  Pose pose;
};

/// Whether a body is in the world.
enum class Presence : std::uint8_t {
  there,   ///< in the world
  unborn,  ///< not yet in the world: belongs to a reserve of bodies that may be born later
  dead,    ///< died, and never comes back
};

/// A row of the component (state table) `life`: whether a body is in the world, and when and where it was
/// born. Tick 0 is the initial state. All members are zero for a body that has been in the world since tick
/// 0. When a body dies, only `presence` changes.
struct Life {
  /// Number of ticks (time steps) that were completed when the body was born; 0 if the body was present at
  /// tick 0 or is unborn.
  std::uint64_t birth = 0;
  /// x of the body's position at birth, m, world frame; 0 if the body was present at tick 0 or is unborn.
  double x = 0;
  /// y of the body's position at birth, m, world frame; 0 if the body was present at tick 0 or is unborn.
  double y = 0;
  std::uint8_t presence = 0;  ///< whether the body is in the world: a value of Presence
};

/// A row of the component (state table) `condition`: whether a body is disabled, and the effects of the
/// faults that have occurred in it. All members are zero for a body that is neither disabled nor affected by
/// a fault, and for a body that is not in the world.
struct Condition {
  /// The reasons why all devices, controllers and the drive of a body are stopped, as bits of Condition::out.
  /// Both reasons may apply at once.
  enum Out : std::uint8_t {
    /// The body is disabled. An intervention (a change that the world file lists), a program or a user sets
    /// this bit, and clears it by enabling the body.
    k_disabled = 1,
    /// A drop-out (a fault that stops a body) stopped the body. The end of any drop-out of the body clears
    /// this bit, even if another drop-out of the body still lasts.
    k_dropped_out = 2,
  };
  /// Factor by which faults scale the velocity that the drive of the body produces: greater than 0, at most
  /// 1. If no fault scales the velocity, the member is 0.
  double speed = 0;
  /// Devices that faults have broken: bit d stands for the device with index d in BodyType::devices, the list
  /// of devices of the body's type. Devices with an index of 32 or more cannot break.
  std::uint32_t dead = 0;
  std::uint8_t out = 0;  ///< bits of Out; each alone stops devices, controllers and drive

  /// Factor by which the velocity of the drive is multiplied.
  double scale() const { return speed == 0 ? 1 : speed; }
  /// Whether no fault affects the body and the body is not disabled.
  bool is_sound() const { return speed == 0 && dead == 0 && out == 0; }
};

/// A row of the component (state table) `contact`: what blocked the row's body in the last tick. All members
/// are zero if nothing did.
///
/// A motion is tested at several poses, its *samples* (class Conflicts). Of all bodies that block it at the
/// earliest blocked sample, `body` is a static one if there is any, and of several the one with the lowest
/// id. Of a tree (bodies that carry one another), the root counts.
struct Contact {
  /// What blocked the body.
  enum Cause : std::uint32_t {
    k_none,    ///< nothing
    k_body,    ///< the body `body` was in the way
    k_pushed,  ///< the body would have pushed `body`, which `behind`, a bound of the world or a limit stops
    k_bounds,  ///< the motion would have ended outside the bounds of the world
    k_joint,   ///< the body could move, but `body` was in the way of a joint, such as that of a gripper
  };
  /// The names of the values of Cause, in their order.
  static constexpr std::array<std::string_view, 5> k_causes{"none", "body", "pushed", "bounds", "joint"};
  std::uint32_t cause = k_none;  ///< a value of Cause
  std::uint32_t body = 0;        ///< id of the body that blocked the motion, plus 1; 0: none
  std::uint32_t behind = 0;      ///< id of the body that stops the pushed body, plus 1; 0: none

  BodyId blocker() const { return body == 0 ? BodyId() : BodyId(body - 1); }      ///< `body` as an id
  BodyId stopper() const { return behind == 0 ? BodyId() : BodyId(behind - 1); }  ///< `behind` as an id

  bool operator==(const Contact&) const = default;
};
/// The largest number of bodies that one body may push in a tick.
inline constexpr std::size_t k_most_pushed = 16;

/// Throws std::logic_error because the state does not have the component `contact`. The text says how to get
/// it.
[[noreturn]] void throw_no_contacts();

}  // namespace troupe::engine
