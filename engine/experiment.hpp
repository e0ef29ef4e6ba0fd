#pragma once

#include "base/ids.hpp"
#include "engine/experiment_spec.hpp"
#include "engine/fault_kind.hpp"
#include "engine/kinds.hpp"

#include <any>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace troupe::engine {

/// The compiled interventions and faults of a world, and which of them are applied next. These data are not
/// part of the state, because they follow from the spec (the description of the world) and the tick.
struct Experiment {
  /// The value of `due` if no intervention or fault event follows: larger than the number of any tick.
  static constexpr std::uint64_t k_never = std::numeric_limits<std::uint64_t>::max();

  /// An intervention (a change of the world at a given time), compiled from its InterventionSpec.
  struct Intervention {
    std::uint64_t tick = 0;    ///< applied after this tick, at the beginning of the next one
    std::size_t spec = 0;      ///< description of the intervention: index into ExperimentSpec::at
    std::uint32_t stream = 0;  ///< stream of its random numbers
    std::vector<BodyId> whom;  ///< all bodies of the group, in order of ids; none for `add`, `set`
    std::size_t reserve = 0;   ///< for `add`: the reserve of the bodies, an index into WorldSpec::reserves
    /// For `set` of a drive or controller: the data that its kind prepared from the new parameters. When the
    /// intervention is applied, they are swapped with the data of the old parameters.
    std::any data;
    DeviceKind::Prepared device;  ///< for `set` of a device: used like `data`, which is then empty
  };
  std::vector<Intervention> interventions;  ///< sorted by tick; within a tick in the order of the file
  std::size_t next = 0;                     ///< index of the next intervention to be applied
  std::size_t made = 0;  ///< number of interventions that World::set() added at the end of ExperimentSpec::at
  /// Empty while World::set() has added nothing. Otherwise the interventions of the world file as they were
  /// at tick 0, which World::reset() and World::restart() restore.
  std::vector<Intervention> declared;

  /// One impairment of a FaultSpec, for the bodies of one type.
  struct Fault {
    Impairment impairment;     ///< effect of the fault on a body, and how often it occurs
    std::uint32_t stream = 0;  ///< stream of its random numbers
  };
  std::vector<Fault> faults;  ///< the faults of all specs, in their order
  /// A fault event: a fault begins or ends in a body.
  struct FaultEvent {
    std::uint64_t tick = 0;   ///< applied after this tick, at the beginning of the next one
    std::uint32_t fault = 0;  ///< the fault: index into `faults`
    BodyId body;              ///< the impaired body
    bool begins = true;       ///< true: the fault begins; false: it ends
  };
  /// The first event of each fault in each body, from the beginning of a run: a heap with the earliest event
  /// on top.
  std::vector<FaultEvent> first_fault_events;
  /// The next event of each fault in each body, from the present tick on: a heap with the earliest event on
  /// top.
  std::vector<FaultEvent> fault_events;

  std::uint64_t due = k_never;  ///< tick of the next intervention or fault event
  /// A body from which a random selection chooses. The bodies with the lowest keys are chosen.
  struct Candidate {
    std::uint64_t key = 0;  ///< random number; equal keys are ordered by id
    BodyId body;            ///< id of the body
  };
  std::vector<Candidate> candidates;  ///< scratch memory of World::choose()
};

}  // namespace troupe::engine
