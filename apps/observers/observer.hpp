#pragma once

#include "troupe/simulation.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace troupe::apps {

/// Base class of objects that are notified of the phases and tasks of each tick (simulation step). A phase is
/// a part of the tick, such as sense or move; a task is a part of a parallel loop. A run calls phase() in its
/// callback of Simulation::on_phase(), and task() in its callback of Simulation::on_task().
class TickWatcher {
 public:
  virtual ~TickWatcher() = default;
  /// Called when a phase of a tick begins, with this phase, and when the tick ends, with std::nullopt.
  virtual void phase(std::optional<Phase> phase) = 0;
  /// Called when a task of a parallel loop begins (`begins` is true) or ends (false), on the thread that runs
  /// the task. Several threads may call it at once. index: index of the task in its loop.
  virtual void task(std::size_t index, bool begins) = 0;
};

/// Base class of objects that observe a run between ticks, most of which write a file: a log, a recording, a
/// profile. An observer must not change the state. If writing fails, an observer throws std::runtime_error,
/// whose text names the file; the run then ends.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// Whether observe() reads the state of robots, not only hashes and times. If it does, and the robots are
  /// divided among several ranks (processes, or groups of threads, that compute the run together), rank 0
  /// fetches the robots of the other ranks after every tick.
  virtual bool reads_robots() const { return true; }
  /// Called once before the first step and after every tick.
  virtual void observe(const Simulation& simulation) = 0;
  /// Called before a checkpoint (a file with the state) is saved during the run, periodically or on request.
  /// The observer must then write everything that it has observed so far to its file, because a run that is
  /// resumed from this checkpoint continues the file.
  virtual void before_save() {}
  /// Called when the run has ended or was stopped, after the last observe().
  virtual void finish(const Simulation& /*simulation*/) {}
  /// Called if another part of the run, such as writing an output, failed after a complete tick. An observer
  /// that saves checkpoints can then still save the state.
  virtual void save_at_least(const Simulation& /*simulation*/) {}
  /// Called after the summary was printed, for slow work that may fail: the summary is then not lost.
  virtual void after_summary(const Simulation& /*simulation*/) {}
  /// Returns a warning for the user about the written file, as one line; empty: none.
  virtual std::string warning() const { return {}; }
  /// Returns the name of the written file and the amount written, for the summary; empty: the summary does
  /// not mention the file.
  virtual std::string result() const { return {}; }
  /// Returns this object if it needs notifications of phases and tasks, else null.
  virtual TickWatcher* tick_watcher() { return nullptr; }
};

}  // namespace troupe::apps
