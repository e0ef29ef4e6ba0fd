#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a remover.
struct RemoverState {
  std::uint64_t removed = 0;  ///< bodies that it has removed since the birth of its body
  TROUPE_FIELDS(removed)
};

/// Removes bodies that come near it from the world: an exit, a pit, a mill.
///
/// which  It removes robots (bodies with a drive), or, if the parameter `of` names a type, the bodies of this
///        type. A body is near if its origin is within `radius` of the remover, whatever the heights. The
///        remover never removes its own body or a body that another body carries. If more than k_most_removed
///        bodies are near in a tick, it removes those with the lowest ids.
/// when   The bodies die at the end of the tick after the one in which they came near (docs/lives.md).
/// state  RemoverState; no commands
engine::DeviceKind remover_kind();

/// Greatest number of bodies that one remover removes in a tick.
inline constexpr std::size_t k_most_removed = 16;

}  // namespace troupe::models
