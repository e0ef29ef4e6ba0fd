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

/// What keeps a body from working as its type says: a row of the component `condition`, all zero of one that
/// is sound.
struct Condition {
  /// Why all of a body has stopped; both may be.
  enum Out : std::uint8_t {
    k_disabled = 1,     ///< it was disabled; until it is enabled again
    k_dropped_out = 2,  ///< a fault; until that passes, if ever
  };
  double speed = 0;        ///< what its drive gives is multiplied by this; 0: it is not slow
  std::uint32_t dead = 0;  ///< devices that do nothing: a bit each
  std::uint8_t out = 0;    ///< bits of Out: where any is set, all of it has stopped

  /// Whether nothing keeps it from working.
  bool is_sound() const { return speed == 0 && dead == 0 && out == 0; }
};

/// The interventions and faults of a world made ready, and which of them come next. Of this nothing is state:
/// it follows from the spec and the tick.
struct Experiment {
  /// The tick of what never comes.
  static constexpr std::uint64_t k_never = std::numeric_limits<std::uint64_t>::max();

  /// An InterventionSpec made ready to run.
  struct Intervention {
    std::uint64_t tick = 0;    ///< it is done when this one has ended
    std::size_t spec = 0;      ///< index into ExperimentSpec::at
    std::uint32_t stream = 0;  ///< of its random numbers
    std::vector<Row> whom;     ///< by id; of `add` empty
    std::size_t reserve = 0;   ///< of `add`
    /// Of `set`, one of the three: what the type runs with from then on; and, while that holds, what it ran
    /// with before.
    std::any data;
    DeviceKind::Prepared device;  ///< instead of `data`, of a device
  };
  std::vector<Intervention> interventions;  ///< by tick; of one tick as the file has them
  std::size_t next = 0;                     ///< of them

  /// One impairment of a FaultSpec, for the bodies that may have it.
  struct Fault {
    Ailment ailment;           ///< what it does to a body
    std::uint32_t stream = 0;  ///< of its random numbers
  };
  std::vector<Fault> faults;  ///< those of all specs, one after another
  /// A fault event: a fault begins or ends in a body.
  struct Strike {
    std::uint64_t tick = 0;   ///< when this one has ended
    std::uint32_t fault = 0;  ///< index into `faults`
    BodyId body;              ///< whom
    Row row;                  ///< its row
    bool begins = true;       ///< false: the fault leaves the body
  };
  std::vector<Strike> first_strikes;  ///< of each fault and body; a heap with the earliest on top, as is
  std::vector<Strike> strikes;        ///< the next of each

  std::uint64_t due = k_never;  ///< the tick of what comes next
  /// A body that an intervention may choose: those with the lowest keys are taken.
  struct Candidate {
    std::uint64_t key = 0;  ///< random; of equal keys the lower id
    BodyId body;            ///< who
    Row row;                ///< its row
  };
  std::vector<Candidate> candidates;  ///< room for a choice
};

}  // namespace troupe::engine
