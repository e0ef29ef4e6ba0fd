#pragma once

#include "engine/world/world.hpp"

#include <memory>

namespace troupe::engine {

/// Returns a new world with the same state as `world`, made in the same way as a world that is restored from
/// a checkpoint file. A test can use such a copy instead of `world` after every tick: if the results then
/// change, the world has state outside the state tables.
///
/// These data are copied: the spec (the description of the world), the number of the tick (time step),
/// World::counters(), the fields of the state tables, and the subscriptions (World::subscribe()). Callbacks
/// are not copied. `options` are the options of the new world. `registry` must be that of `world`, and must
/// outlive the new world. Throws std::logic_error if the last step of `world` threw (World::require_whole()),
/// or if the new world has another hash than `world`.
std::unique_ptr<World> remade_world(World& world, const Registry& registry, const WorldOptions& options);

}  // namespace troupe::engine
