#pragma once

#include "base/ids.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

namespace troupe::engine {

// The verbs (Effect::verb) of births and deaths. Devices of all kinds may emit them; a kind that emits deaths
// must set the flag DeviceKind::Prepared::ends_lives. The engine itself applies them after all other effects
// of the tick (time step): first all deaths, then all births, each in the order of Effects::sorted().
/// Value of Effect::verb: the next body of a reserve is born. A reserve is a list of bodies that are not yet
/// in the world. They are born in the order of their ids. Effect::reserve selects the reserve.
/// Effect::payload is the pose at birth: x, y, z (m), heading (rad), world frame. If Effect::source dies in
/// the same tick (time step), no body is born.
inline constexpr std::uint32_t k_birth = ~0u;
/// Value of Effect::verb: the body Effect::target dies. Nothing happens if the target is not valid(), is not
/// in the world, or is a static body. A static body has no drive, device or controller, and cannot be gripped
/// or pushed.
inline constexpr std::uint32_t k_death = ~0u - 1;

/// The outcome of a request for a birth. Devices store the numerical values in their state, which is saved to
/// files, so the value of an enumerator must never change.
enum class BirthStatus : std::uint8_t {
  unasked,   ///< no birth was requested
  born,      ///< the body Birth::body was born
  occupied,  ///< no birth: the pose is occupied, outside the bounds of the world, or not finite
  used_up,   ///< no birth: all bodies of the reserve (bodies that may be born later) have been born
};
/// The result of a requested birth. If a device requested the birth, the engine passes the result to the hook
/// DeviceKind::born. If a program requested the birth, World::spawn() returns the result.
struct Birth {
  BirthStatus status = BirthStatus::unasked;  ///< whether a body was born, or why not
  BodyId body;                                ///< the new body; invalid if none was born
};

/// An action of a device on a body, such as gripping, charging or releasing it. A device is equipment of a
/// body, such as a gripper. While a device runs, it must not write to the state of other bodies. Instead it
/// emits an effect, which is a record of the action. Devices emit effects in any order and on any thread.
/// After all bodies have moved in the tick (time step), the effects are applied one by one, in an order that
/// does not depend on the threads. The function DeviceKind::apply applies an effect. DeviceKind is the table
/// of functions that implements one sort of device.
struct Effect {
  BodyId source;             ///< the acting body
  std::uint32_t device = 0;  ///< the acting device: index in BodyType::devices of the type of `source`
  /// Number that orders the effects of one device of one body in a tick. Each of these effects must have a
  /// different number: World::step() throws a StepError if two have the same, because they have no order.
  std::uint32_t sequence = 0;
  std::uint32_t verb = 0;  ///< the action: k_birth, k_death, or a number that the device's kind defines
  BodyId target;           ///< the affected body; not valid() if there is none
  /// Arguments of the verb, in SI units; positions are in the world frame. The device's kind defines their
  /// meaning.
  std::array<double, 4> payload{};
  std::uint32_t reserve = 0;  ///< for a birth: reserve of the new body, an index into WorldSpec::reserves

  /// Whether the effect is a birth or a death, which the engine itself applies.
  bool is_of_life() const { return verb == k_birth || verb == k_death; }
};

/// The effects of one tick, in a list of limited length.
class Effects {
 public:
  /// Allocates room for `most` effects in a tick, and removes all effects. Not thread-safe.
  void reserve(std::size_t most);
  /// Adds an effect. Thread-safe. Throws std::length_error if the list is full. A device has then emitted
  /// more effects than its kind declares (DeviceKind::Prepared::most_effects). After such an exception, only
  /// clear() and reserve() may be called.
  void emit(const Effect& effect);
  /// Sorts the effects emitted since the last clear() by (source, device, sequence) and returns them. Not
  /// thread-safe. The result is valid until the next call of a function that is not const.
  std::span<const Effect> sorted();
  /// The effects emitted since the last clear(), in any order. No thread may call emit() meanwhile. The
  /// result is valid until the next call of a function that is not const.
  std::span<const Effect> emitted() const { return {effects_.get(), count_}; }
  void clear() { count_ = 0; }                ///< removes all effects; keeps the memory
  bool empty() const { return count_ == 0; }  ///< whether there are no effects

 private:
  std::unique_ptr<Effect[]> effects_;
  std::size_t most_ = 0;
  std::atomic<std::size_t> count_ = 0;
};

}  // namespace troupe::engine
