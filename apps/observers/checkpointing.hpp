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
  /// Returns true if SIGUSR1 has arrived at a process of the run since the previous call. One request of the
  /// user may arrive several times, because a launcher such as mpirun passes the signal on to all processes.
  /// Therefore the function returns false for one second after a call that returned true, and ignores the
  /// signals in this time.
  ///
  /// simulation: the simulation of the run, which counts the signals at the other processes
  bool has_new(const Simulation& simulation);

 private:
  std::uint64_t seen_ = 0;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

/// Saves checkpoints of a run. A checkpoint is a file with the whole state, from which the run can be
/// resumed. The class saves a checkpoint periodically, on SIGUSR1, and when the run ends or is stopped.
class Checkpointing : public Observer {
 public:
  /// file: the checkpoint. Each save replaces it.
  /// every_s: interval of the periodic checkpoints, simulated seconds; not given: no periodic checkpoints
  /// was_resumed_from_file: whether `file` is the checkpoint from which the run was resumed
  /// simulation: the simulation of the run
  /// others: the other observers of the run, which must outlive this object. Before each checkpoint during
  /// the run, this object calls their before_save().
  Checkpointing(std::filesystem::path file, std::optional<double> every_s, bool was_resumed_from_file,
                const Simulation& simulation, std::vector<Observer*> others);

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }
  void finish(const Simulation& simulation) override;
  /// Saves a checkpoint only if the run has none yet: the files that other observers could not finish may end
  /// before the present tick, and only the earlier checkpoint can then continue them.
  void save_at_least(const Simulation& simulation) override;

 private:
  void save(const Simulation& simulation);

  std::filesystem::path file_;
  bool was_resumed_from_file_;
  std::vector<Observer*> others_;
  std::uint64_t period_ = 0;            // ticks; 0: only at the end
  std::uint64_t first_tick_;            // tick at which the run began or was resumed; needs no checkpoint
  std::optional<std::uint64_t> saved_;  // the tick of the last checkpoint
  SaveRequests requests_;
};

/// Tests whether checkpoints can be saved: writes a checkpoint into the folder of `file`, or of the file to
/// which the link `file` points, and removes it again. Throws OutputError if this fails, for example because
/// the disk is full. The user then sees the error before the run.
void rehearse_checkpoint(const std::filesystem::path& file, const Simulation& simulation);

/// Returns the RunOutput for checkpoints (Checkpointing). A RunOutput is one output of a run, together with
/// its command-line options. The options are --checkpoint, --checkpoint-every and --wall-limit. Parsing
/// stores their values in RunOptions::checkpoint, checkpoint_every_s and wall_limit_s. Without --checkpoint,
/// nothing is saved.
std::unique_ptr<RunOutput> checkpoint_output();

}  // namespace troupe::apps
