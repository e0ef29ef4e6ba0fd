#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// What a remover has done.
struct RemoverState {
  std::uint64_t removed = 0;  ///< bodies, since its own life began
  TROUPE_FIELDS(removed)
};

/// Ends the lives of bodies that come to it: an exit, a pit, a mill.
///
/// who    robots (bodies with a drive), or with `of` the bodies of the type of this name, whose origin lies
///        within `radius` of its own, whatever their height; but for its own body, and for those that
///        are carried. Of more than k_most_removed in a tick the lowest ids
/// when   they die at the end of the tick after the one that brought them (docs/lives.md)
/// state  RemoverState; no commands
engine::DeviceKind remover_kind();

/// Bodies that one remover takes in a tick.
inline constexpr std::size_t k_most_removed = 16;

}  // namespace troupe::models
