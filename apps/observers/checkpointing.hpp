#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace troupe::apps {

/// Saves the run in a checkpoint periodically and when it ends or is stopped.
class Checkpointing : public Observer {
 public:
  /// every_s: the period in simulated seconds; not given: a checkpoint is saved only at the end. others: the
  /// other observers of the run, which must outlive this object; before_save() is called on them before each
  /// periodic checkpoint. Writes a trial checkpoint next to the file and removes it, so that a full disk or a
  /// world that cannot be saved is reported before the run. Throws OutputError if that fails.
  Checkpointing(std::filesystem::path file, std::optional<double> every_s, const Simulation& simulation,
                std::vector<Observer*> others);

  void observe(const Simulation& simulation) override;
  void finish(const Simulation& simulation) override;
  void save_at_least(const Simulation& simulation) override { finish(simulation); }

 private:
  void save(const Simulation& simulation);

  std::filesystem::path file_;
  std::vector<Observer*> others_;
  std::uint64_t period_ = 0;  // ticks; 0: only at the end
  std::uint64_t first_tick_;
  std::optional<std::uint64_t> saved_;  // the tick of the last checkpoint
};

/// The output of --checkpoint, --checkpoint-every and --wall-limit, which fill RunOptions::checkpoint,
/// ::checkpoint_every_s and ::wall_limit_s.
std::unique_ptr<RunOutput> checkpoint_output();

}  // namespace troupe::apps
