#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace troupe::apps {

/// Saves the run in its checkpoint every so often, and when it ends or is stopped.
class Checkpointing : public Observer {
 public:
  /// others: what the run writes beside it, told before each checkpoint; they outlive it.
  /// every_s: of simulated time, on the world's clock; not given: at the end alone. Writes a whole checkpoint
  /// beside the file and removes it, so that a disk without room, or a world that cannot be saved, is known
  /// before the run. Throws OutputError.
  Checkpointing(std::filesystem::path file, std::optional<double> every_s, const Simulation& simulation,
                std::vector<Observer*> others);

  void observe(const Simulation& simulation) override;
  void finish(const Simulation& simulation) override;
  void save_at_least(const Simulation& simulation) override { finish(simulation); }

 private:
  void save(const Simulation& simulation);

  std::filesystem::path file_;
  std::vector<Observer*> others_;
  std::uint64_t period_ = 0;  // ticks; 0: at the end alone
  std::uint64_t first_tick_;
  std::optional<std::uint64_t> saved_;  // the tick of the last checkpoint
};

/// --checkpoint, --checkpoint-every and --wall-limit: RunOptions::checkpoint and the two next to it.
std::unique_ptr<RunOutput> checkpoint_output();

}  // namespace troupe::apps
