#pragma once

#include "base/ids.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

namespace troupe::engine {

/// Verbs that the engine itself carries out, of whatever device: births and deaths. They come when all other
/// effects of the tick are settled, first the deaths, then the births, each in the order of the effects.
inline constexpr std::uint32_t k_birth = ~0u;  ///< `reserve`; `payload`: x, y, z (m), heading (rad), world
inline constexpr std::uint32_t k_death = ~0u - 1;  ///< of `target`

/// What became of a birth. Numbers are part of the state of who asked.
enum class BirthStatus : std::uint8_t {
  unasked,   ///< none was asked for yet
  born,      ///< it is there: Birth::body
  occupied,  ///< something stands there, or it lies outside of the world
  used_up,   ///< no body of the reserve remains
};
/// How a birth ended, as DeviceKind::born is told and World::spawn() returns it.
struct Birth {
  BirthStatus status = BirthStatus::unasked;  ///< why no body was born, where none was
  BodyId body;                                ///< that was born; else not valid
};

/// What one body does to another in a tick: grips it, feeds it, drops it. A record, because no body writes
/// into another's rows: it is emitted while all decide, in any order and on any thread, and applied when all
/// have moved, one by one, in an order that is a property of the world.
struct Effect {
  BodyId source;                    ///< who does it
  std::uint32_t device = 0;         ///< that does it: index within the source's type
  std::uint32_t sequence = 0;       ///< among those of one device in one tick
  std::uint32_t verb = 0;           ///< what: a matter of the device's kind
  BodyId target;                    ///< not valid where there is none
  std::array<double, 4> payload{};  ///< a matter of the verb: SI, world frame where they are places
  std::uint32_t reserve = 0;        ///< of a birth: index into WorldSpec::reserves

  /// Whether the engine itself carries it out.
  bool is_of_life() const { return verb == k_birth || verb == k_death; }
};

/// The effects of one tick.
class Effects {
 public:
  /// Makes room for so many in a tick.
  void reserve(std::size_t most);
  /// From any worker. Throws std::length_error where a device emits more than its kind declared.
  void emit(const Effect& effect);
  /// Those emitted since the last clear(), by (source, device, sequence).
  std::span<const Effect> sorted();
  void clear() { count_ = 0; }                ///< none is left; keeps the room
  bool empty() const { return count_ == 0; }  ///< whether none was emitted since the last clear()

 private:
  std::unique_ptr<Effect[]> effects_;
  std::size_t most_ = 0;
  std::atomic<std::size_t> count_ = 0;
};

}  // namespace troupe::engine
