#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// What controllers ask of a spawner: a birth more each time that `request` grows by 1.
struct SpawnerCommand {
  std::uint32_t request = 0;  ///< births asked for so far
  TROUPE_FIELDS(request)

  void ask() { ++request; }  ///< for one more
};

/// What a spawner has done.
struct SpawnerState {
  std::uint64_t flags = 0;    ///< of those that its body was given: how many have counted
  std::uint32_t born = 0;     ///< of it, since its own life began
  std::uint32_t owed = 0;     ///< births still to come
  std::uint32_t refused = 0;  ///< births that failed because their place was taken
  std::uint32_t request = 0;  ///< the last one that has counted
  std::uint32_t last = 0;     ///< id + 1 of who was born last
  std::uint8_t status = 0;    ///< of the last birth it asked for: engine::BirthStatus
  TROUPE_FIELDS(flags, born, owed, refused, request, last, status)
};

/// Bears bodies of a population's reserve: a nest, a door, a factory.
///
/// when    every `every` of its life; for each `per_flags` flags that its body was given; and when a
///         controller asks. A birth that is due is owed until it succeeds: one a tick is tried
/// where   at its own pose; with `within`, anywhere in the circle about it, heading anywhere, drawn again for
///         each try. Where something solid stands there, or the place lies outside of the world, it is tried
///         again in the next tick
/// who     the next body of the population, docs/lives.md; once none is left it asks no more
/// state   SpawnerState; commands: SpawnerCommand
engine::DeviceKind spawner_kind();

}  // namespace troupe::models
