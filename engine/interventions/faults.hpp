#pragma once

#include "base/diagnostics.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/state/world_state.hpp"

#include <cstddef>
#include <cstdint>

namespace troupe::engine {

class Groups;  // engine/interventions/groups.hpp

/// The faults of a world: random failures of robots.
class Faults {
 public:
  /// The arguments must outlive the object.
  Faults(WorldState& state, Experiment& experiment) : state_(state), experiment_(experiment) {}
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;

  /// Compiles the faults of the spec, selects the bodies that may fail, and computes the first event of each
  /// fault in each of these bodies. Throws InputError if the spec of a fault has errors.
  void build(const Registry& registry, Groups& groups, Diagnostics& diagnostics);
  /// Computes from the tick which fault events are next: those before the present tick have been applied.
  void derive();
  void apply_due();  ///< applies the fault events that are due at the end of the last completed tick

 private:
  void build_fault(std::size_t at, const Registry& registry, Groups& groups, Diagnostics& diagnostics);
  std::uint64_t next_tick(std::uint32_t fault, BodyId body, std::uint64_t from) const;
  Experiment::FaultEvent take_event();
  void apply(const Experiment::FaultEvent& event);

  WorldState& state_;
  Experiment& experiment_;
};

}  // namespace troupe::engine
