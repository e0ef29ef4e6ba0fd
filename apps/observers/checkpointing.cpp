#include "apps/observers/checkpointing.hpp"

#include "apps/interrupt.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/run/run_options.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/input_files.hpp"
#include "worldio/files.hpp"
#include "worldio/partial_file.hpp"

#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;

bool SaveRequests::has_new(const Simulation& simulation) {
  const std::uint64_t requests = save_requests() + simulation.rank_statistics().requests;
  if (requests == seen_) return false;
  seen_ = requests;
  const auto now = std::chrono::steady_clock::now();
  if (last_ && now - *last_ < std::chrono::seconds(1)) return false;
  last_ = now;
  return true;
}

Checkpointing::Checkpointing(fs::path file, std::optional<double> every_s, bool was_resumed_from_file,
                             const Simulation& simulation, std::vector<Observer*> others)
    : file_(std::move(file)),
      was_resumed_from_file_(was_resumed_from_file),
      others_(std::move(others)),
      period_(every_s ? engine::period_ticks(*every_s, simulation.tick_s()) : 0),
      first_tick_(simulation.tick()) {}

void Checkpointing::observe(const Simulation& simulation) {
  const std::uint64_t tick = simulation.tick();
  const bool is_due = period_ > 0 && tick % period_ == 0 && tick != first_tick_;
  if (!requests_.has_new(simulation) && !is_due) return;
  for (Observer* other : others_) other->before_save();
  save(simulation);
}

void Checkpointing::finish(const Simulation& simulation) {
  if (saved_ != simulation.tick()) save(simulation);
}

void Checkpointing::save_at_least(const Simulation& simulation) {
  if (!saved_ && !was_resumed_from_file_) save(simulation);
}

void Checkpointing::save(const Simulation& simulation) {
  simulation.save(file_);
  saved_ = simulation.tick();
}

void rehearse_checkpoint(const fs::path& file, const Simulation& simulation) {
  // The partial file is in the folder in which save() writes, and has the permissions of the checkpoint that
  // it replaces, as every checkpoint has. The rehearsal then replaces the partial file.
  std::optional<worldio::PartialFile> partial;
  try {
    partial.emplace(file, ".rehearsal");
  } catch (const std::system_error& error) {
    refuse_output(file, error.code().message());
  }
  try {
    simulation.save(partial->path());
  } catch (const std::runtime_error& error) {
    throw OutputError(worldio::error_about(error.what(), partial->path(), file));
  }
}

namespace {

/// Throws OutputError if the file of the checkpoint exists, unless `force` is true or the run was resumed
/// from this file.
void check_checkpoint(const fs::path& file, const fs::path& resumed_from, bool force) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return;
  if (!fs::is_regular_file(file, ignored)) refuse_output(file, "it is not a regular file");
  if (force) return;
  if (!resumed_from.empty() && fs::equivalent(file, resumed_from, ignored)) return;
  refuse_existing(file);
}

/// Returns the checkpoint from which the run is resumed; empty for a new run.
fs::path resumed_from(const RunOptions& options) {
  return options.is_checkpoint ? options.world : fs::path();
}

class CheckpointOutput : public ClonedOutput<CheckpointOutput> {
 public:
  void add_options(CLI::App& app, RunOptions& options) override {
    CLI::Option* checkpoint = add_value(
        app, "--checkpoint", "FILE.h5",
        "Save the state on SIGUSR1 and when the run ends or is stopped; troupe resume continues the run",
        [&options](const std::string& text) { options.checkpoint = hdf5_name("--checkpoint", text); });
    add_value(
        app, "--checkpoint-every", "S", "Also save the checkpoint every S simulated seconds",
        [&options](const std::string& text) {
          options.checkpoint_every_s = positive_seconds("--checkpoint-every", text, "a simulated time");
        },
        checkpoint);
    add_value(app, "--wall-limit", "S",
              "Stop when S seconds of real time have passed since the start of the program",
              [&options](const std::string& text) {
                options.wall_limit_s = positive_seconds("--wall-limit", text, "a real time");
              });
  }
  std::vector<fs::path*> names(RunOptions& options) override { return {&options.checkpoint}; }
  std::vector<fs::path> files(const RunOptions& options) const override {
    check_checkpoint(options.checkpoint, resumed_from(options), options.force);
    // A checkpoint that replaces the resumed one is also an input; check_outputs() would refuse it.
    if (same_file(options.checkpoint, resumed_from(options))) return {};
    return {options.checkpoint};
  }
  OpenOutput prepare(const RunOptions& options, Simulation& simulation, std::uint64_t) const override {
    if (options.checkpoint.empty()) return nullptr;
    if (!options.dry_run) rehearse_checkpoint(options.checkpoint, simulation);
    return [&options, &simulation](Observers& observers) {
      std::vector<Observer*> others;
      for (const auto& observer : observers) others.push_back(observer.get());
      observers.push_back(std::make_unique<Checkpointing>(
          options.checkpoint, options.checkpoint_every_s,
          same_file(options.checkpoint, resumed_from(options)), simulation, std::move(others)));
    };
  }
};

}  // namespace

std::unique_ptr<RunOutput> checkpoint_output() { return std::make_unique<CheckpointOutput>(); }

}  // namespace troupe::apps
