#pragma once

#include "base/ids.hpp"
#include "engine/kinds/device_kind.hpp"
#include "engine/kinds/fault_kind.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/spec/experiment_spec.hpp"

#include <any>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace troupe::engine {

/// The interventions and faults of a world, compiled from its spec (the description of the world), and which
/// of them are applied next. World can compute these data again from the spec and the number of the tick, so
/// they are not part of the state.
///
/// - A *tick* is a time step.
/// - An *intervention* is a change of the world at a given time, such as removing robots.
/// - A *fault* is a random failure of a robot. A *fault event* is the beginning or the end of a fault in a
///   body.
/// - A *kind* is the implementation of one sort of device, drive, controller or fault.
/// - A *random stream* is a sequence of random numbers. It is identified by a number, which stream_id()
///   computes from two names.
struct Experiment {
  /// The value of the member `due` if no intervention or fault event follows. It is larger than the number of
  /// any tick.
  static constexpr std::uint64_t k_never = std::numeric_limits<std::uint64_t>::max();

  /// What World::set() needs to know of a type to compile a change of its parameters.
  struct Basis;

  /// An intervention, compiled from its InterventionSpec.
  struct Intervention {
    std::uint64_t tick = 0;  ///< applied after this tick, at the beginning of the next one
    std::size_t spec = 0;    ///< its InterventionSpec: index into ExperimentSpec::at
    /// Random stream of the intervention: stream_id("at", I), where I is the index `spec`, as a decimal
    /// number. 0 if World::set() has added the intervention, which then needs no random numbers.
    std::uint32_t stream = 0;
    /// Ids of all bodies of the group InterventionSpec::whom, in ascending order, including bodies that are
    /// not in the world. Interventions on the same group share one list. Null for the interventions `add`
    /// (spawns bodies) and `set` (changes parameters).
    std::shared_ptr<const std::vector<BodyId>> whom;
    std::size_t reserve = 0;  ///< for `add`: list of bodies to spawn, index into WorldSpec::reserves
    /// For `set` of a drive or controller. Before the intervention is applied: the data that the kind of the
    /// drive or controller has prepared from the new parameters. Afterwards: the data of the old parameters.
    /// To apply the intervention, World swaps `data` with the data in BodyType.
    std::any data;
    DeviceKind::Prepared device;  ///< for `set` of a device: used in place of `data`
    /// For `set` of a drive or a drive device: new data of all controllers of the type, because controllers
    /// may have stored limits of the drive. Swapped in the same way as `data`. Empty if no controller kind of
    /// the type has the function `bind_world`: controllers can read the drive only in that function.
    std::vector<std::any> controllers;
    /// Set only for the last `set` of a type that World::set() has added: what the next call for this type
    /// needs. The call then need not read all earlier interventions.
    std::shared_ptr<const Basis> basis;
  };
  /// Sorted by tick; within a tick in the order of ExperimentSpec::at.
  std::vector<Intervention> interventions;
  std::size_t next = 0;  ///< index of the next intervention to be applied; interventions.size(): none
  /// Number of interventions that World::set() has added since construction, World::reset() or
  /// World::restart(). Their specs are the last elements of ExperimentSpec::at.
  std::size_t made = 0;
  /// The changes that World::set() has made since the last step. They are in force before the next step,
  /// unlike the other interventions of the same tick. They are the last interventions of this tick.
  struct Present {
    std::uint64_t tick = 0;      ///< the tick in which they were made
    std::uint64_t settings = 0;  ///< their number
  };
  Present present;  ///< the changes of the present tick, or of the tick in which World::set() was last called
  /// A copy of `interventions` as they were before World::set() added the first one, with none of them
  /// applied. World::reset() and World::restart() restore this copy. Empty while World::set() has added no
  /// intervention.
  std::vector<Intervention> declared;

  /// One impairment (effect on a body) of a FaultSpec, compiled for the bodies of one type.
  struct Fault {
    Impairment impairment;  ///< effect of the fault on a body, and how often it occurs
    /// Random stream of the fault: stream_id(KIND, I), where KIND is the name of the kind of fault, and I is
    /// the index of its FaultSpec in ExperimentSpec::faults, as a decimal number.
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
  /// The first event of each fault in each body that was selected for this fault: a heap with the earliest
  /// event on top. Each run begins with a copy of this heap in `fault_events`.
  std::vector<FaultEvent> first_fault_events;
  /// The next event of each fault in each body: a heap with the earliest event on top. A fault that no longer
  /// occurs in a body has no event there.
  std::vector<FaultEvent> fault_events;

  std::uint64_t due = k_never;        ///< tick after which the next intervention or fault event is applied
  std::vector<Candidate> candidates;  ///< scratch: the bodies among which choose() chooses
  /// Chooses as many of `candidates` as the group asks for: those with the lowest keys. Returns them in order
  /// of ids; valid until the list changes.
  std::span<const Candidate> choose(const GroupSpec& group);
};

/// Returns the indices of the interventions of a spec (ExperimentSpec::at) in the order in which they are
/// applied: by ticks, and in the order of the indices within a tick.
///
/// tick_s: length of a tick, s; above 0
std::vector<std::size_t> order_of_interventions(const ExperimentSpec& spec, double tick_s);

}  // namespace troupe::engine
