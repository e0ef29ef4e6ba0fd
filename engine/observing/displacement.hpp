#pragma once

#include "engine/world/world.hpp"

namespace troupe::engine {

/// Mean straight-line distance between the present position of a robot and its origin
/// (CommittedView::origin()), over all robots in the world, m; 0 if there are none. If the rows are
/// distributed among ranks, call World::gather() before. Throws as World::require_whole().
double mean_displacement(const World& world);

}  // namespace troupe::engine
