#pragma once

#include "base/ids.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

namespace troupe::engine {

/// Verbs of any device that the engine itself applies: births and deaths. They are applied after all other
/// effects of the tick, first the deaths, then the births, each in the order of the effects.
inline constexpr std::uint32_t k_birth = ~0u;  ///< `reserve`; `payload`: x, y, z (m), heading (rad), world
inline constexpr std::uint32_t k_death = ~0u - 1;  ///< death of `target`

/// The result of a birth. The numbers are stored in the state of the requesting device.
enum class BirthStatus : std::uint8_t {
  unasked,   ///< no birth was requested yet
  born,      ///< Birth::body was born
  occupied,  ///< the place is occupied or outside the world
  used_up,   ///< the reserve has no body left
};
/// The result of a birth, as passed to DeviceKind::born and returned by World::spawn().
struct Birth {
  BirthStatus status = BirthStatus::unasked;  ///< whether a body was born, or why not
  BodyId body;                                ///< the new body; invalid if none was born
};

/// An action of one body on another in a tick: it grips, feeds or drops it. Effects are records because no
/// body may write to the rows of another: they are emitted while all bodies decide, in any order and on any
/// thread, and applied one by one after all bodies have moved, in an order that is independent of threads.
struct Effect {
  BodyId source;                    ///< the acting body
  std::uint32_t device = 0;         ///< the acting device: index within the source's type
  std::uint32_t sequence = 0;       ///< order among the effects of one device in one tick
  std::uint32_t verb = 0;           ///< the action; defined by the device's kind
  BodyId target;                    ///< invalid if there is none
  std::array<double, 4> payload{};  ///< arguments of the verb: SI units; places in the world frame
  std::uint32_t reserve = 0;        ///< for a birth: index into WorldSpec::reserves

  /// Whether the engine itself applies it.
  bool is_of_life() const { return verb == k_birth || verb == k_death; }
};

/// The effects of one tick.
class Effects {
 public:
  /// Allocates room for `most` effects in a tick.
  void reserve(std::size_t most);
  /// Adds an effect; thread-safe. Throws std::length_error if there are more than reserve() allowed: a device
  /// emitted more than its kind declared.
  void emit(const Effect& effect);
  /// Returns the effects emitted since the last clear(), sorted by (source, device, sequence).
  std::span<const Effect> sorted();
  void clear() { count_ = 0; }                ///< removes all effects; keeps the memory
  bool empty() const { return count_ == 0; }  ///< whether there are no effects

 private:
  std::unique_ptr<Effect[]> effects_;
  std::size_t most_ = 0;
  std::atomic<std::size_t> count_ = 0;
};

}  // namespace troupe::engine
