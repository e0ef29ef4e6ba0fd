#pragma once

#include "troupe/simulation.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace troupe::apps {

/// Is notified within ticks, by Simulation's on_phase() and on_task().
class TickWatcher {
 public:
  virtual ~TickWatcher() = default;
  virtual void phase(std::optional<Phase> phase) = 0;
  virtual void task(std::size_t index, bool begins) = 0;
};

/// Writes an output of a run between ticks: a log, a recording, a profile. It must not change the state.
/// Write errors are std::runtime_error with the file's name and end the run.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// Called once before the first step and after every tick.
  virtual void observe(const Simulation& simulation) = 0;
  /// Called before the state is saved. Must flush everything observed so far, because a run resumed from that
  /// checkpoint continues this file.
  virtual void before_save() {}
  /// Called when the run has ended or was stopped, after the last observe().
  virtual void finish(const Simulation& /*simulation*/) {}
  /// Called if another part of the run failed after a complete tick: a checkpoint still saves the state.
  virtual void save_at_least(const Simulation& /*simulation*/) {}
  /// Called after the summary is printed, for slow work that may fail: the summary is then not lost.
  virtual void after_summary(const Simulation& /*simulation*/) {}
  /// A warning about the file for the user, one line; empty: none.
  virtual std::string warning() const { return {}; }
  /// The file and the amount written, for the summary; empty: not listed.
  virtual std::string result() const { return {}; }
  /// This object if it needs notifications of phases and tasks, else null.
  virtual TickWatcher* tick_watcher() { return nullptr; }
};

}  // namespace troupe::apps
