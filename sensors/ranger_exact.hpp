#pragma once

#include "engine/state_table.hpp"
#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

#include <span>

namespace troupe::sensors {

/// The exact engine: writes the readings of these rows, all of one type, whose ranger stands on this joint.
void cast_exact(const engine::World& world, const RangerBeams& ranger, std::span<const Row> rows,
                std::int32_t joint, engine::StateTable& percepts);

}  // namespace troupe::sensors
