#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// State of a remover, a device that removes bodies (robots or objects) from the world.
struct RemoverState {
  /// Number of bodies that the remover has removed since its own body came into the world. If several
  /// removers remove the same body in the same tick (time step), the body counts for each of them.
  std::uint64_t removed = 0;

  static constexpr void describe(engine::Description<RemoverState>& d) {
    d.member<&RemoverState::removed>("removed",
                                     "number of bodies that the remover has removed since the birth of its "
                                     "body");
  }
};

/// Returns the definition of the device `remover`: it removes from the world the bodies that come near it. It
/// can model an exit, a pit or a crusher.
///
/// which  A body comes near if its origin is within the parameter `radius` (m) of the remover, seen from
///        above. The remover removes robots (bodies with a drive) or, if the parameter `of` names a type of
///        the world file, the bodies of this type; a type of static bodies is an error. The remover does not
///        remove its own body or bodies that another body carries. Of the bodies that are near in a tick
///        (time step), it removes at most k_most_removed: those with the lowest ids.
/// when   A body that is near at the end of a tick dies at the end of the next tick (docs/lives.md).
/// state  RemoverState; no commands
engine::DeviceKind remover_kind();

/// Greatest number of bodies that one remover removes in a tick (time step).
inline constexpr std::size_t k_most_removed = 16;

}  // namespace troupe::models
