#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// A flag: a coloured token. Bodies hold flags and exchange them, for example as loads that robots deliver.
struct Flag {
  std::uint32_t color = 0;  ///< colour, 0xRRGGBBAA
  /// Size, m, which Stage's flags also have. It has no effect.
  float size = 0;
  friend bool operator==(const Flag&, const Flag&) = default;
};
inline constexpr Flag k_yellow_flag{0xffff00ff, 0.25f};  ///< a yellow flag of 0.25 m, as in Stage's examples

/// The command of the device `flags`, a list of flags: one operation on the list. A controller gives a
/// command by calling ask(), which increases `request`. The new value tells the device to carry out the
/// operation once, in the next tick (time step). If a controller calls ask() twice in a tick, only the
/// second operation is carried out.
struct FlagCommand {
  /// An operation. "This list" is the list of the device that gets the command.
  enum Verb : std::uint8_t {
    nothing,  ///< no operation
    push,     ///< adds a new flag at the front of this list
    pop,      ///< deletes the first flag of this list
    take,     ///< moves the first flag of the body `target` to the front of this list
    give,     ///< moves the first flag of this list to the front of the list of the body `target`
  };
  std::uint32_t request = 0;    ///< number of operations requested so far
  std::uint32_t target = 0;     ///< id of the other body (BodyId::value), for `take` and `give`
  std::uint32_t color = 0;      ///< Flag::color of the flag that `push` adds, 0xRRGGBBAA
  float size = 0;               ///< Flag::size of the flag that `push` adds, m
  std::uint8_t verb = nothing;  ///< the operation, a Verb

  static constexpr void describe(engine::Description<FlagCommand>& d) {
    using enum engine::Unit;
    d.member<&FlagCommand::request>("request", "number of operations requested so far");
    d.member<&FlagCommand::target>(
        "target", "id of the body from which `take` takes a flag, or to which `give` gives a flag");
    d.member<&FlagCommand::color>("color", "colour of the flag that `push` adds, 0xRRGGBBAA");
    d.member<&FlagCommand::size>("size", meters, "size of the flag that `push` adds");
    d.member<&FlagCommand::verb>("verb", "operation: 0: none, 1: push, 2: pop, 3: take, 4: give");
  }

  /// Requests an operation. of_whom: id of the other body (BodyId::value); used only for `take` and `give`.
  /// flag: the flag to add; used only for `push`.
  void ask(Verb what, std::uint32_t of_whom = 0, const Flag& flag = {}) {
    ++request;
    verb = what;
    target = of_whom;
    color = flag.color;
    size = flag.size;
  }
};

/// The indices of the fields of the state of the device `flags`.
enum FlagField : std::size_t {
  k_flag_received,  ///< u64: number of flags that other bodies gave (`give`) to the list since tick 0
  k_flag_count,     ///< u32: number of flags in the list
  k_flag_request,   ///< u32: value of FlagCommand::request that the device has read last
  k_flag_colors,    ///< array of u32: Flag::color of each flag, first flag first; 0 after the last flag
  k_flag_sizes,     ///< array of f32: Flag::size of each flag, m, first flag first
};

/// Returns the definition of the device `flags`: a list of flags that a body holds. The parameter `most` is
/// the greatest number of flags in the list. The parameter `yellow` is the number of flags (k_yellow_flag) in
/// the list at the start.
///
/// edges  These operations have no effect:
///        - `push` to a full list
///        - `pop` from an empty list
///        - `take` or `give`, if the list that loses the flag is empty or the list that gets it is full
///        - `take` or `give`, if the other body is not in the world, has no list of flags, or is the same
///          body
///        If the other body has several lists, the first one is used.
/// order  `take` and `give` are carried out after all motions of the tick, one after another, in the order of
///        the ids of the requesting bodies. So if two bodies want to take the last flag of a list, the body
///        with the lower id gets it. No flag is lost or duplicated.
engine::DeviceKind flags_kind();

}  // namespace troupe::models
