#pragma once

#include "troupe/simulation.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace troupe::apps {

/// What is told as a tick goes on, and not only between ticks: Simulation's on_phase() and on_task().
class TickWatcher {
 public:
  virtual ~TickWatcher() = default;
  virtual void phase(std::optional<Phase> phase) = 0;
  virtual void task(std::size_t index, bool begins) = 0;
};

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
  /// Another part of the run failed behind a tick that is whole: the state is saved where it was to be.
  virtual void save_at_least(const Simulation& /*simulation*/) {}
  /// The summary is printed. What takes long and may fail comes now, so that it takes no numbers with it.
  virtual void after_summary(const Simulation& /*simulation*/) {}
  /// What the user must know of the file, a line; empty: nothing.
  virtual std::string warning() const { return {}; }
  /// What it has written, for the summary: the file and how much is in it; empty: nothing that needs telling.
  virtual std::string result() const { return {}; }
  /// Itself, where it wants to be told phases and tasks; else null.
  virtual TickWatcher* tick_watcher() { return nullptr; }
};

}  // namespace troupe::apps
