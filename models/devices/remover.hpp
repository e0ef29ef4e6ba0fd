#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a remover, a device that removes bodies (robots or objects) from the world.
struct RemoverState {
  /// Number of bodies that the remover has removed since the birth of its own body. A body that several
  /// removers remove in the same tick (simulation step) counts for each of them.
  std::uint64_t removed = 0;

  static constexpr void describe(engine::Description<RemoverState>& d) {
    d.member<&RemoverState::removed>("removed",
                                     "number of bodies that the remover has removed since the birth of its "
                                     "body");
  }
};

/// Returns the definition of the device `remover`, which removes from the world the bodies that come near the
/// device. It can model an exit, a pit or a crusher.
///
/// which  A remover removes robots (bodies with a drive), or, if the parameter `of` names a type of the world
///        file, the bodies of this type. A body is near if its origin is within the parameter `radius` (m) of
///        the remover, seen from above. The remover never removes its own body or a body that another body
///        carries. If more than k_most_removed bodies are near in a tick, it removes those with the lowest
///        ids.
/// when   A body that is near at the end of one tick dies at the end of the next tick (docs/lives.md).
/// state  RemoverState; no commands
engine::DeviceKind remover_kind();

/// Greatest number of bodies that one remover removes in a tick (simulation step).
inline constexpr std::size_t k_most_removed = 16;

}  // namespace troupe::models
