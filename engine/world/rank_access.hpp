#pragma once

#include "base/ids.hpp"
#include "base/result.hpp"
#include "engine/interventions/interventions.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/links/links.hpp"
#include "engine/rows/lives.hpp"
#include "engine/rows/rows.hpp"
#include "engine/state/world_state.hpp"
#include "engine/world/activities.hpp"
#include "engine/world/derivation.hpp"
#include "engine/world/tick.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace troupe::engine {

/// What the ranks that compute a world together may do with the World of a rank, beyond its public functions.
/// The World passes it to Ranks::join().
class RankAccess {
 public:
  /// The arguments must outlive the object.
  RankAccess(WorldState& state, Movement& movement, Links& links, Rows& rows, Lives& lives,
             Interventions& interventions, Tick& tick, Derivation& derivation, Activities& activities)
      : state_(state),
        movement_(movement),
        links_(links),
        rows_(rows),
        lives_(lives),
        interventions_(interventions),
        tick_(tick),
        derivation_(derivation),
        activities_(activities) {}
  RankAccess(const RankAccess&) = delete;
  RankAccess& operator=(const RankAccess&) = delete;

  std::span<StateTable> tables() { return state_.tables; }  ///< the state tables
  Effects& effects() { return tick_.effects(); }            ///< the effects of the tick
  Links& links() { return links_; }                 ///< the joints, and the poses to which devices move them
  std::uint64_t& beams() { return tick_.beams(); }  ///< rays cast by all sensors since tick 0

  /// Replaces the state by that of rank 0, after a program has changed the state on rank 0. Calls `fill`,
  /// which writes the tables, and sets the tick. Recomputes all data that are derived from the state. Unlike
  /// World::restore(), checks nothing.
  ///
  /// is_in_tick   whether the interventions of the present tick have already been applied
  void adopt(std::uint64_t tick, const std::function<void(std::span<StateTable>)>& fill, bool is_in_tick);
  /// Makes the change of World::set() at the tick that rank 0 has, after a call of set() on rank 0. If the
  /// program has replaced the state on rank 0, for example by restore(), this rank may be at another tick:
  /// the function then sets the tick and applies the settings of earlier ticks, so that the change follows
  /// the same interventions as on rank 0. adopt() must follow in this case. Unlike set(), the function may be
  /// called while the state of this rank is incomplete.
  ///
  /// tick   tick of rank 0
  Result<> set_at(std::uint64_t tick, const SettingSpec& setting, const Registry& registry);
  /// Removes the rows of `leaving`, and then adds those of `coming` after the remaining rows, also during a
  /// tick. Afterwards, the first `own` rows are the own rows, which this rank computes
  /// (WorldState::own_rows). The rows after them are copies of rows of other ranks.
  ///
  /// leaving   bodies with rows in this world. The last rows fill the places of the removed rows. If an own
  ///           row leaves, all copies must therefore leave too: otherwise a copy could get the place of the
  ///           own row
  /// coming    the rows to add
  void exchange_rows(std::span<const BodyId> leaving, std::span<const RowState> coming, std::size_t own);
  /// Returns the data of a row, as RowState::bytes contains them.
  std::vector<std::byte> row_bytes(Row row) { return rows_.bytes(row); }
  /// Number of bodies of each reserve that have been born. All ranks have the same numbers.
  std::span<const std::uint32_t> births() const { return lives_.births(); }
  /// Sets the numbers of births() to those on rank 0. Called after adopt() if the rows are distributed among
  /// ranks.
  void set_births(std::span<const std::uint32_t> births) { lives_.set_births(births); }

 private:
  WorldState& state_;
  Movement& movement_;
  Links& links_;
  Rows& rows_;
  Lives& lives_;
  Interventions& interventions_;
  Tick& tick_;
  Derivation& derivation_;
  Activities& activities_;
};

}  // namespace troupe::engine
