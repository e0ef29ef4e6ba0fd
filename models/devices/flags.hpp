#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// A token that a body holds.
struct Flag {
  std::uint32_t color = 0;  ///< 0xRRGGBBAA
  float size = 0;           ///< m
  friend bool operator==(const Flag&, const Flag&) = default;
};
inline constexpr Flag k_yellow_flag{0xffff00ff, 0.25f};  ///< the flag of Stage's examples

/// The command of a list of flags. It is carried out once, in the next tick, each time `request` changes;
/// ask() changes it.
struct FlagCommand {
  /// Operation on flags.
  enum Verb : std::uint8_t {
    nothing,  ///< no operation
    push,     ///< adds a new flag at the front
    pop,      ///< deletes the first flag
    take,     ///< moves the first flag of `target` to its own front
    give,     ///< moves its own first flag to the front of `target`
  };
  std::uint32_t request = 0;    ///< see ask()
  std::uint32_t target = 0;     ///< BodyId
  std::uint32_t color = 0;      ///< of the flag that `push` adds, 0xRRGGBBAA
  float size = 0;               ///< of the flag that `push` adds, m
  std::uint8_t verb = nothing;  ///< a Verb
  TROUPE_FIELDS(request, target, color, size, verb)

  /// Requests an operation for the next tick. of_whom: the other body (a BodyId) of `take` and `give`; flag:
  /// the new flag of `push`.
  void ask(Verb what, std::uint32_t of_whom = 0, const Flag& flag = {}) {
    ++request;
    verb = what;
    target = of_whom;
    color = flag.color;
    size = flag.size;
  }
};

/// Indices of the fields of the state of a list of flags.
enum FlagField : std::size_t {
  k_flag_received,  ///< u64: flags received from other bodies since tick 0
  k_flag_count,     ///< u32: flags that it holds
  k_flag_request,   ///< u32: the last request that was carried out
  k_flag_colors,    ///< u32 each, first flag first; 0 after the last
  k_flag_sizes,     ///< f32 each, m
};

/// A list of at most `most` flags (a parameter).
///
/// edges  a push to a full list, a pop from an empty one, and a transfer without a flag to give, without
///        room, or without a list on the other side have no effect
/// order  transfers are effects, applied after all motions in the order of ids: if two bodies take the last
///        flag, the one with the lower id gets it; no flag is lost or duplicated
engine::DeviceKind flags_kind();

}  // namespace troupe::models
