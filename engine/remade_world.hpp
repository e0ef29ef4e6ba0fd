#pragma once

#include "engine/world.hpp"

#include <memory>

namespace troupe::engine {

/// Another world in the state of this one. It is made from its spec, its tick, the fields of its tables and
/// its subscriptions alone, as a resumed run is: nothing else that the world held goes along, so that a run
/// which is made again after every tick shows whatever hides outside of the tables. The registry must outlive
/// it. Throws std::logic_error where the state does not have the hash that it had.
std::unique_ptr<World> remade_world(World& world, const Registry& registry, const WorldOptions& options);

}  // namespace troupe::engine
