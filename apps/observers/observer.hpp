#pragma once

#include "troupe/simulation.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace troupe::apps {

/// Base class of objects that are notified during each tick (time step), for example to measure times.
/// A phase is a part of the tick, such as sense or move. A task is a part of a parallel loop; one thread runs
/// the task. A run calls phase() whenever Simulation::on_phase() reports a phase, and task() whenever
/// Simulation::on_task() reports a task.
class TickWatcher {
 public:
  virtual ~TickWatcher() = default;
  /// Called with a phase when this phase of a tick begins, and with std::nullopt when the tick ends.
  virtual void phase(std::optional<Phase> phase) = 0;
  /// Called when a task of a parallel loop begins (`begins` is true) or ends (false), on the thread that runs
  /// the task. Several threads may call it at the same time. index: index of the task in its loop.
  virtual void task(std::size_t index, bool begins) = 0;
};

/// Base class of objects that observe a run between ticks (time steps). Most observers write a file,
/// such as a log, a recording or a profile. An observer must not change the state. If writing fails, an
/// observer throws std::runtime_error, whose text names the file; the run then ends.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  /// Whether observe() needs the state of robots after every tick. The robots may be divided among several
  /// ranks (processes, or groups of threads, that compute the run together). If an observer returns true,
  /// rank 0 then fetches the robots of all ranks after every tick. An observer returns false if it needs only
  /// hashes, times or counts, or if its observe() itself fetches the robots (engine::World::gather()) after
  /// the ticks whose robots it needs.
  virtual bool reads_robots() const { return true; }
  /// Called once before the first tick and after every tick.
  virtual void observe(const Simulation& simulation) = 0;
  /// Called before a checkpoint (a file with the state) is saved during the run. The observer must then write
  /// everything that it has observed so far to its file, because a run that is resumed from the checkpoint
  /// continues this file.
  virtual void before_save() {}
  /// Called when the run has ended or was stopped, after the last observe().
  virtual void finish(const Simulation& /*simulation*/) {}
  /// Called if another part of the run, such as writing an output, failed after a complete tick. An observer
  /// that saves checkpoints can then save the state before the program ends.
  virtual void save_at_least(const Simulation& /*simulation*/) {}
  /// Called after the program has printed the summary of the run. Slow work that may fail belongs here,
  /// because an error then does not prevent the summary.
  virtual void after_summary(const Simulation& /*simulation*/) {}
  /// Returns a warning for the user about the written file, as one line, or an empty text.
  virtual std::string warning() const { return {}; }
  /// Returns the name of the written file and the amount written, for the summary of the run. If the text is
  /// empty, the summary does not mention the file.
  virtual std::string result() const { return {}; }
  /// Returns this object if it is also a TickWatcher, else null.
  virtual TickWatcher* tick_watcher() { return nullptr; }
};

}  // namespace troupe::apps
