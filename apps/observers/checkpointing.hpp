#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace troupe::apps {

/// Detects that a user has requested a checkpoint (a file with the state of the run) by sending SIGUSR1 to a
/// process of the run.
class SaveRequests {
 public:
  /// Whether a request has arrived since the previous call. Requests within one second after a call that
  /// returned true are ignored: a launcher passes a signal on to all processes, so that one request of the
  /// user arrives several times.
  bool has_new(const Simulation& simulation);

 private:
  std::uint64_t seen_ = 0;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

/// Saves checkpoints of a run, that is, files with its whole state, from which it can be resumed:
/// periodically, on SIGUSR1, and when the run ends or is stopped.
class Checkpointing : public Observer {
 public:
  /// file: the checkpoint, which each save replaces. every_s: the period in simulated seconds; not given: no
  /// periodic checkpoints. others: the other observers of the run, which must outlive this object; their
  /// before_save() is called before each checkpoint during the run, so that they write what they have
  /// observed to their files. The constructor writes a trial checkpoint next to `file` and removes it, so
  /// that a full disk or a world that cannot be saved is reported before the run. Throws OutputError if this
  /// fails.
  Checkpointing(std::filesystem::path file, std::optional<double> every_s, const Simulation& simulation,
                std::vector<Observer*> others);

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }
  void finish(const Simulation& simulation) override;
  void save_at_least(const Simulation& simulation) override { finish(simulation); }

 private:
  void save(const Simulation& simulation);

  std::filesystem::path file_;
  std::vector<Observer*> others_;
  std::uint64_t period_ = 0;            // ticks; 0: only at the end
  std::uint64_t first_tick_;            // tick at which the run began or was resumed; needs no checkpoint
  std::optional<std::uint64_t> saved_;  // the tick of the last checkpoint
  SaveRequests requests_;
};

/// Returns the output of a run (an object with command-line options, see RunOutput) that saves checkpoints
/// (Checkpointing). It adds the options --checkpoint, --checkpoint-every and --wall-limit to the command
/// line. Parsing stores their values in RunOptions::checkpoint, checkpoint_every_s and wall_limit_s. Without
/// --checkpoint, nothing is saved.
std::unique_ptr<RunOutput> checkpoint_output();

}  // namespace troupe::apps
