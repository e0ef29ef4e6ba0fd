#pragma once

#include "troupe/simulation.hpp"

namespace troupe::apps {

/// What a run writes between its ticks: a log, a recording, a profile. It changes nothing of the state.
/// Errors in writing are std::runtime_error that name the file, and end the run.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// The simulation stands at a tick: at the one with which the run begins, then at each that has ended.
  virtual void observe(const Simulation& simulation) = 0;
  /// What was observed is in its file when this returns: the state is about to be saved, and who goes on from
  /// it must find all that went before.
  virtual void before_save() {}
  /// The run has ended, or was stopped, at the tick that was observed last.
  virtual void finish(const Simulation& /*simulation*/) {}
};

}  // namespace troupe::apps
