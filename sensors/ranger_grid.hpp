#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

#include <span>

namespace troupe::sensors {

/// Readings of the rows of one type, whose ranger stands on this joint, by the grid engine, which the world
/// must have (World::ray_grid()): percepts as ranger_kind() describes them, but for what cells make of them,
/// docs/sensing.md.
void cast_grid(const engine::World& world, const RangerBeams& ranger, std::span<const Row> rows,
               std::int32_t joint, engine::StateTable& percepts);

}  // namespace troupe::sensors
