#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// A token that a model holds.
struct Flag {
  std::uint32_t color = 0;  ///< 0xRRGGBBAA
  float size = 0;           ///< m
  friend bool operator==(const Flag&, const Flag&) = default;
};
inline constexpr Flag k_yellow_flag{0xffff00ff, 0.25f};  ///< what Stage's examples hand about

/// What controllers ask of a holder of flags: carried out once, in the next tick, whenever `request` is
/// another number than before (flag_request() makes it one).
struct FlagCommand {
  /// What is to be done with flags.
  enum Verb : std::uint8_t {
    nothing,  ///< leave them as they are
    push,     ///< a new flag, to the front
    pop,      ///< the first one vanishes
    take,     ///< the first one of `target`, to its own front
    give,     ///< its own first one, to the front of `target`
  };
  std::uint32_t request = 0;    ///< see ask()
  std::uint32_t target = 0;     ///< BodyId
  std::uint32_t color = 0;      ///< of a flag that is pushed, 0xRRGGBBAA
  float size = 0;               ///< of a flag that is pushed, m
  std::uint8_t verb = nothing;  ///< a Verb
  TROUPE_FIELDS(request, target, color, size, verb)

  /// Has it done in the next tick. flag: of `push`; of_whom: of `take` and `give`, a BodyId.
  void ask(Verb what, std::uint32_t of_whom = 0, const Flag& flag = {}) {
    ++request;
    verb = what;
    target = of_whom;
    color = flag.color;
    size = flag.size;
  }
};

/// Fields of the state of a holder, in their order.
enum FlagField : std::size_t {
  k_flag_received,  ///< u64: flags that others gave it since tick 0
  k_flag_count,     ///< u32: flags it holds
  k_flag_request,   ///< u32: the last one that was carried out
  k_flag_colors,    ///< u32 each, from the front; 0 behind the last
  k_flag_sizes,     ///< f32 each, m
};

/// A list of flags, as many as the parameter `most` says.
///
/// edges  a push to a full list, a pop from an empty one, and a transfer where there is nothing to give, no
///        room, or no holder on the other side, do nothing
/// order  transfers are effects: of two that reach for the last flag the lower id has it; a flag that changes
///        hands is never lost
engine::DeviceKind flags_kind();

}  // namespace troupe::models
