#include "engine/world/rank_access.hpp"

namespace troupe::engine {

void RankAccess::adopt(std::uint64_t tick, const std::function<void(std::span<StateTable>)>& fill,
                       bool is_in_tick) {
  activities_.complete();
  fill(state_.tables);
  state_.now.tick = tick;
  if (!is_in_tick) interventions_.derive();
  derivation_.derive_state();
}

Result<> RankAccess::set_at(std::uint64_t tick, const SettingSpec& setting, const Registry& registry) {
  if (tick != state_.now.tick) {
    state_.now.tick = tick;
    interventions_.derive();
  }
  return interventions_.set(setting, registry);
}

void RankAccess::exchange_rows(std::span<const BodyId> leaving, std::span<const RowState> coming,
                               std::size_t own) {
  if (rows_.exchange(leaving, coming, own))
    derivation_.derive_rows();
  else
    movement_.count_stalls();
}

}  // namespace troupe::engine
