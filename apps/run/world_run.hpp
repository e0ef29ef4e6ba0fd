#pragma once

#include "apps/observers/checkpointing.hpp"
#include "apps/observers/observer.hpp"
#include "apps/run/load_clock.hpp"
#include "apps/run/phase_clock.hpp"
#include "apps/run/report.hpp"
#include "apps/run/run_options.hpp"
#include "live/view.hpp"
#include "troupe/session.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace troupe::apps {

class Pacer;

/// One loaded world of a run, with the observers that write its outputs. A tick is a step of the simulation;
/// an observer is an object that reads the state after each tick, for example to record it. The caller calls,
/// in this order: take_names_from_world(), rehearse(), open_outputs(), open_view() if the run is shown in
/// browsers, begin(), step() until is_done(), finish(), print_summary(), after_summary().
class WorldRun {
 public:
  /// Loads or resumes the world and prints its warnings. options: the options of one world; {world} must
  /// already be replaced in the names of its outputs. Throws InputError if the world, the checkpoint or the
  /// session is invalid, if the run has no end, or if the end is earlier than the checkpoint.
  explicit WorldRun(RunOptions options);
  ~WorldRun();
  WorldRun(const WorldRun&) = delete;
  WorldRun& operator=(const WorldRun&) = delete;

  const RunOptions& options() const { return options_; }
  const Simulation& simulation() const { return simulation_; }
  /// Takes the file names of outputs from the world if the world has them and the command line does not.
  /// Returns the options with these names. Throws InputError if a name is not allowed.
  const RunOptions& take_names_from_world();

  /// Prepares the outputs (RunOutput::prepare()), so that errors in them are reported before any file is
  /// opened.
  void rehearse();
  /// Opens the outputs. is_over: a function that returns true if the run was asked to stop; waiting because
  /// of RunOptions::rate then ends early.
  void open_outputs(std::function<bool()> is_over);
  /// Shows the run in browsers and prints the addresses on standard error. is_over: a function that returns
  /// true if the run was asked to stop. It is also called while a user has paused the run; if it then returns
  /// true, the run ends.
  void open_view(const std::function<bool()>& is_over);
  /// Whether the run prints lines with the simulated time (--clock); a progress bar would interfere with
  /// them.
  bool tells_time() const;
  /// Prints the effective options on standard output.
  void print_options() const;

  /// Prints on standard output what the run would need (--dry-run), as text or JSON. Call it instead of the
  /// functions below.
  void print_dry_run() const;

  /// Calls observe() of all observers for the current tick. Call it once, before the first step().
  void begin();
  /// Makes one step, and then calls observe() of all observers.
  void step();
  /// Whether the run has reached its last tick, or a condition in the world's `stop_when` holds.
  bool is_done() const { return simulation_.tick() >= ticks_ || simulation_.stopped(); }
  /// Simulated time at the end of the next tick, s.
  double next_s() const { return static_cast<double>(simulation_.tick() + 1) * simulation_.tick_s(); }
  /// Calls finish() of all observers and fills the report.
  void finish();
  /// Saves the checkpoint although the run has failed, for example because an output could not be written.
  /// Does nothing without --checkpoint or if the last step itself failed. Ignores errors of writing.
  void save_at_least() const;

  const Report& report() const { return report_; }
  /// Prints warnings on standard error, and the summary on standard output, as text or JSON (with
  /// RunOptions::quiet, only as JSON). Throws std::runtime_error if standard output cannot be written.
  /// is_one_of_several: the run has several worlds, so the summary begins with the name of the world.
  void print_summary(bool is_one_of_several) const;
  /// Calls after_summary() of the observers.
  void after_summary() const;

 private:
  using Clock = std::chrono::steady_clock;
  void fetch_robots();
  void observe();

  RunOptions options_;
  Clock::time_point start_ = Clock::now();
  Simulation simulation_;
  std::unique_ptr<SessionReplay> session_;
  Report report_;
  std::uint64_t ticks_ = 0;           // the last tick of the run
  std::vector<OpenOutput> prepared_;  // outputs that are not open yet
  Observers observers_;
  std::vector<TickWatcher*> watchers_;  // the observers that are notified of phases and tasks
  const Pacer* pacer_ = nullptr;
  PhaseClock phases_;
  LoadClock load_;
  std::unique_ptr<live::View> view_;  // null without RunOptions::view
  SaveRequests requests_;             // for the warning of a run without a checkpoint file
  bool is_intact_ = true;             // false after a failed step, because the state is then invalid
};

}  // namespace troupe::apps
