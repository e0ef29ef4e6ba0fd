#pragma once

#include "base/ids.hpp"
#include "engine/kinds/fault_kind.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/experiment_spec.hpp"

#include <any>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace troupe::engine {

/// The compiled interventions and faults of a world, and which of them are applied next. An intervention is a
/// change of the world at a given time, such as removing robots; a fault is a random failure of a robot. A
/// kind is a table of functions that implements one sort of device, drive, controller or fault. A random
/// stream is a sequence of random numbers with a number of its own. A tick is a time step. These data are not
/// part of the state, because they follow from the spec (the description of the world) and the tick.
struct Experiment {
  /// The value of `due` if no intervention or fault event follows: larger than the number of any tick.
  static constexpr std::uint64_t k_never = std::numeric_limits<std::uint64_t>::max();

  /// An intervention, compiled from its InterventionSpec.
  struct Intervention {
    std::uint64_t tick = 0;  ///< applied after this tick, at the beginning of the next one
    std::size_t spec = 0;    ///< its InterventionSpec: index into ExperimentSpec::at
    /// Random stream of the intervention: stream_id("at", INDEX), with `spec` as INDEX; 0 if World::set() has
    /// added the intervention.
    std::uint32_t stream = 0;
    /// All bodies of the group InterventionSpec::whom, in order of ids, whether or not they are in the world.
    /// Empty for the interventions `add` (spawns bodies) and `set` (changes parameters).
    std::vector<BodyId> whom;
    std::size_t reserve = 0;  ///< for `add`: list of bodies to spawn, index into WorldSpec::reserves
    /// For `set` of a drive or controller: the data that its kind prepared from the new parameters. Applying
    /// the intervention swaps these data with those in BodyType; `data` then holds the data of the old
    /// parameters.
    std::any data;
    DeviceKind::Prepared device;  ///< for `set` of a device: used like `data`, which is then empty
    /// For `set` of a drive: the data of the controllers of the type, prepared again because controllers may
    /// have stored limits of the drive. Used like `data`. Empty if no kind of these controllers has the
    /// function `bind_world`, which reads the description of the world.
    std::vector<std::any> controllers;
  };
  /// Sorted by tick; within a tick in the order of ExperimentSpec::at.
  std::vector<Intervention> interventions;
  std::size_t next = 0;  ///< index of the next intervention to be applied; interventions.size(): none
  /// Number of interventions that World::set() has added since construction, World::reset() or
  /// World::restart(). Their specs are the last ones of ExperimentSpec::at.
  std::size_t made = 0;
  /// A copy of the interventions of the world file, in the state before the first tick. World::reset() and
  /// World::restart() restore it. Empty while World::set() has added no intervention.
  std::vector<Intervention> declared;

  /// One impairment (effect on a body) of a FaultSpec, compiled for the bodies of one type.
  struct Fault {
    Impairment impairment;  ///< effect of the fault on a body, and how often it occurs
    /// Random stream of the fault: stream_id() of the name of its kind and of the index of its FaultSpec.
    std::uint32_t stream = 0;
  };
  /// One entry for each impairment of each FaultSpec and each type of the selected bodies, in the order of
  /// ExperimentSpec::faults.
  std::vector<Fault> faults;
  /// A fault event: a fault begins or ends in a body. It has no effect if the body is not in the world at
  /// that time.
  struct FaultEvent {
    std::uint64_t tick = 0;   ///< applied after this tick, at the beginning of the next one
    std::uint32_t fault = 0;  ///< the fault: index into `faults`
    BodyId body;              ///< the impaired body
    bool begins = true;       ///< true: the fault begins; false: it ends
  };
  /// For each fault, and for each body that was selected for this fault, the first event of a run: a heap
  /// with the earliest event on top. At tick 0, `fault_events` is a copy of this heap.
  std::vector<FaultEvent> first_fault_events;
  /// The next event of each fault in each body, after those that were applied so far: a heap with the
  /// earliest event on top. A fault that occurs no more has no event.
  std::vector<FaultEvent> fault_events;

  std::uint64_t due = k_never;  ///< tick after which the next intervention or fault event is applied
  /// A body that a random selection may choose. The selection takes the bodies with the lowest keys.
  struct Candidate {
    std::uint64_t key = 0;  ///< random number; of bodies with equal keys, the lowest id is taken first
    BodyId body;            ///< id of the body
  };
  std::vector<Candidate> candidates;  ///< scratch memory of World::choose()
};

}  // namespace troupe::engine
