#pragma once

#include "base/ids.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

namespace troupe::engine {

// The verbs (Effect::verb) of births and deaths. Any device may emit them. The engine itself applies them
// after all other effects of the tick: first all deaths, then all births, each in the order of
// Effects::sorted().
/// Birth of the next body of the reserve Effect::reserve, which holds bodies that are not yet in the world.
/// The payload is the pose of the birth: x, y, z (m), heading (rad), world frame.
inline constexpr std::uint32_t k_birth = ~0u;
/// Death of Effect::target.
inline constexpr std::uint32_t k_death = ~0u - 1;

/// Whether a requested body was born. The numerical values are stored in the state of the requesting device.
enum class BirthStatus : std::uint8_t {
  unasked,   ///< no birth was requested yet
  born,      ///< the body Birth::body was born
  occupied,  ///< the place is occupied or outside the world
  used_up,   ///< the reserve has no body left
};
/// The result of a birth, as passed to DeviceKind::born and returned by World::spawn().
struct Birth {
  BirthStatus status = BirthStatus::unasked;  ///< whether a body was born, or why not
  BodyId body;                                ///< the new body; invalid if none was born
};

/// An action of one body on another in a tick, such as gripping, charging or releasing it. A device must not
/// write to the rows of other bodies in the state tables. Instead, the device emits an effect, which is a
/// record of the action. Devices emit effects in the phase `actuate`, in any order and on any thread. After
/// all bodies have moved, the effects are applied one by one, in an order that does not depend on the
/// threads.
struct Effect {
  BodyId source;                    ///< the acting body
  std::uint32_t device = 0;         ///< the acting device: index within the source's type
  std::uint32_t sequence = 0;       ///< orders the effects that one device of one body emits in a tick
  std::uint32_t verb = 0;           ///< the action; defined by the device's kind
  BodyId target;                    ///< the affected body; not valid() if there is none
  std::array<double, 4> payload{};  ///< arguments of the verb, in SI units; positions in the world frame
  std::uint32_t reserve = 0;        ///< for a birth: index into WorldSpec::reserves

  /// Whether the effect is a birth or a death, which the engine itself applies.
  bool is_of_life() const { return verb == k_birth || verb == k_death; }
};

/// The effects of one tick.
class Effects {
 public:
  /// Allocates room for `most` effects in a tick.
  void reserve(std::size_t most);
  /// Adds an effect; thread-safe. Throws std::length_error if there are more effects than reserve() allowed:
  /// a device then emitted more than its kind declared (DeviceKind::Prepared::most_effects).
  void emit(const Effect& effect);
  /// Returns the effects emitted since the last clear(), sorted by (source, device, sequence).
  std::span<const Effect> sorted();
  /// The effects emitted since the last clear(), in any order.
  std::span<const Effect> emitted() const { return {effects_.get(), count_}; }
  void clear() { count_ = 0; }                ///< removes all effects; keeps the memory
  bool empty() const { return count_ == 0; }  ///< whether there are no effects

 private:
  std::unique_ptr<Effect[]> effects_;
  std::size_t most_ = 0;
  std::atomic<std::size_t> count_ = 0;
};

}  // namespace troupe::engine
