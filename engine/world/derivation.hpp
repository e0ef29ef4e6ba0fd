#pragma once

#include "engine/conflicts/movement.hpp"
#include "engine/interventions/interventions.hpp"
#include "engine/links/links.hpp"
#include "engine/rows/lives.hpp"
#include "engine/rows/places.hpp"
#include "engine/state/world_state.hpp"
#include "engine/world/tick.hpp"

namespace troupe::engine {

/// Computes the derived data of a world: those that are neither constant, nor state, nor set by the program.
/// Reads only the spec, the tick and the tables, never earlier derived data.
class Derivation {
 public:
  /// The arguments must outlive the object.
  Derivation(WorldState& state, Links& links, Movement& movement, Places& places, Lives& lives,
             Interventions& interventions, Tick& tick)
      : state_(state),
        links_(links),
        movement_(movement),
        places_(places),
        lives_(lives),
        interventions_(interventions),
        tick_(tick) {}
  Derivation(const Derivation&) = delete;
  Derivation& operator=(const Derivation&) = delete;

  /// Computes all derived data. Called after every start, reset and restore.
  void derive();
  /// The part of derive() without the odometry errors of robots and the interventions and faults of the spec.
  void derive_state();
  /// The part of derive() that depends on which rows are here. Called after bodies have got other rows, and
  /// after rows were removed or added. The lists of placed bodies stay.
  void derive_rows();
  /// For tests: overwrites all derived data with junk, and then computes them again.
  void forget();

 private:
  WorldState& state_;
  Links& links_;
  Movement& movement_;
  Places& places_;
  Lives& lives_;
  Interventions& interventions_;
  Tick& tick_;
};

}  // namespace troupe::engine
