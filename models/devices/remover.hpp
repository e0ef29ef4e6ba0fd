#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a remover.
struct RemoverState {
  std::uint64_t removed = 0;  ///< bodies that it has removed since its own birth
  TROUPE_FIELDS(removed)
};

/// Removes bodies that come near it: an exit, a pit, a mill.
///
/// which  robots (bodies with a drive), or with `of` the bodies of the type of this name, whose origin is
///        within `radius` of its own, whatever their height; not its own body, nor bodies that are carried.
///        Of more than k_most_removed bodies in a tick, those with the lowest ids
/// when   they die at the end of the tick after the one in which they came near (docs/lives.md)
/// state  RemoverState; no commands
engine::DeviceKind remover_kind();

/// Bodies that one remover removes in a tick, at most.
inline constexpr std::size_t k_most_removed = 16;

}  // namespace troupe::models
