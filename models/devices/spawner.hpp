#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The command of a spawner: one more birth each time that `request` grows by 1.
struct SpawnerCommand {
  std::uint32_t request = 0;  ///< births requested so far
  TROUPE_FIELDS(request)

  void ask() { ++request; }  ///< requests one more birth
};

/// State of a spawner.
struct SpawnerState {
  std::uint64_t flags = 0;    ///< flags received by its body that have been counted
  std::uint32_t born = 0;     ///< bodies that it has spawned since its own birth
  std::uint32_t owed = 0;     ///< births still due
  std::uint32_t refused = 0;  ///< births that failed because the place was occupied
  std::uint32_t request = 0;  ///< the last request that has been counted
  std::uint32_t last = 0;     ///< id + 1 of the body that it spawned last; 0: none
  std::uint8_t status = 0;    ///< result of its last birth, an engine::BirthStatus
  TROUPE_FIELDS(flags, born, owed, refused, request, last, status)
};

/// Spawns bodies from the reserve of a population: a nest, a door, a factory.
///
/// when    each `every` seconds of its life; for each `per_flags` flags that its body receives; and on the
///         command of a controller. A birth stays due until it succeeds; one is tried per tick
/// where   at its own pose; with `within`, at a random position in the circle around it, with a random
///         heading, drawn again for each try. If the place is occupied by something solid, or is outside the
///         bounds of the world, it is tried again in the next tick
/// which   the next body of the reserve (docs/lives.md); once the reserve is used up, it tries no more births
/// state   SpawnerState; commands: SpawnerCommand
engine::DeviceKind spawner_kind();

}  // namespace troupe::models
