#pragma once

#include "engine/world/world.hpp"

#include <memory>

namespace troupe::engine {

/// Returns a new world with the same state as `world`. Like a world that is restored from a checkpoint file,
/// the new world is made only from five things: the spec (the description of the world), the number of the
/// tick (time step), World::counters(), the fields of the state tables, and the bodies with
/// World::subscribe(). Callbacks are not copied. A test that replaces the world in this way after every tick
/// therefore detects state that is kept outside the tables. `options` are those of the new world. `registry`
/// must be that of `world`, and must outlive the new world. Throws std::logic_error if the last step of
/// `world` threw (World::require_whole()), or if the new world has another hash than `world`.
std::unique_ptr<World> remade_world(World& world, const Registry& registry, const WorldOptions& options);

}  // namespace troupe::engine
