#include "engine/ranks/replica.hpp"
#include "engine/world/world.hpp"

namespace troupe::engine {

ReplicaParts World::join(Replica* replica) {
  replica_ = replica;
  return {state_.tables, effects_, links_, beams_};
}

void World::gather_rows() const { replica_->gather(); }

void World::gather_distributed() const {
  if (replica_ != nullptr) replica_->gather_distributed();
}

void World::touch_rows() { replica_->touch(); }

void World::adopt(std::uint64_t tick, const Fill& fill, bool is_in_tick) {
  is_half_made_ = false;
  fill(state_.tables);
  state_.now.tick = tick;
  if (!is_in_tick) derive_experiment();
  derive_state();
}

}  // namespace troupe::engine
