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

/// One loaded world of a run, with the observers that write its outputs. A tick is a step of the simulation.
/// An observer is an object that reads the state after each tick, for example to record it. The caller calls
/// in this order:
///
/// - take_names_from_world(), rehearse(), open_outputs();
/// - open_view(), only if the run is shown in browsers;
/// - begin(), and then step() until is_done() returns true;
/// - finish(), print_summary(), after_summary().
class WorldRun {
 public:
  /// Loads or resumes the world and prints its warnings. In the output names of `options`, {world} must
  /// already be replaced. Throws InputError if the world, the checkpoint or the session is invalid, if the
  /// run has no end, or if the checkpoint was saved after the end of the run.
  explicit WorldRun(RunOptions options);
  ~WorldRun();
  WorldRun(const WorldRun&) = delete;
  WorldRun& operator=(const WorldRun&) = delete;

  const RunOptions& options() const { return options_; }
  const Simulation& simulation() const { return simulation_; }
  /// For each output without a file name on the command line, takes the name that the world gives, if any.
  /// Returns the options with these names. Throws InputError if a name in the world is not allowed.
  const RunOptions& take_names_from_world();

  /// Calls RunOutput::prepare() for all outputs, so that errors are reported before any file is opened.
  void rehearse();
  /// Opens the outputs. If the speed of the run is limited (RunOptions::rate), step() waits after each tick.
  /// It stops waiting when is_over() returns true.
  ///
  /// is_over: a function that returns true once the run must stop
  void open_outputs(std::function<bool()> is_over);
  /// Shows the run in browsers and prints the addresses on standard error. While a user has paused the run,
  /// step() waits. It stops waiting when is_over() returns true.
  ///
  /// is_over: a function that returns true once the run must stop
  void open_view(const std::function<bool()>& is_over);
  /// Whether the run prints lines with the simulated time (--clock). The caller must then show no progress
  /// bar, because it would interfere with the lines.
  bool tells_time() const;
  /// Prints the options of the run and their values, including defaults, on standard output.
  void print_options() const;

  /// Prints on standard output what the run would need, such as the number of ticks and the memory, as text
  /// or JSON. For --dry-run, call it after rehearse(), in place of all functions that follow in the class
  /// comment.
  void print_dry_run() const;

  /// Notifies all observers of the first state, with Observer::observe(). Call it once, before the first
  /// step().
  void begin();
  /// Computes one tick, and then notifies all observers, with Observer::observe().
  void step();
  /// Whether the run has reached its last tick, or a condition in the world's `stop_when` holds.
  bool is_done() const { return simulation_.tick() >= ticks_ || simulation_.stopped(); }
  /// Whether a process of another rank has received a signal that requests the end of the run.
  bool is_stopped_elsewhere() const { return simulation_.rank_statistics().is_stop_requested; }
  /// Simulated time at the end of the next tick, s.
  double next_s() const { return static_cast<double>(simulation_.tick() + 1) * simulation_.tick_s(); }
  /// Calls finish() of all observers and fills the report.
  void finish();
  /// For a run that fails, for example because an output cannot be written: saves the state after the last
  /// tick to the file of --checkpoint. Does nothing if there is no such file or if the last step itself
  /// failed. Ignores errors of writing.
  void save_at_least() const;

  const Report& report() const { return report_; }
  /// Prints warnings on standard error and the summary on standard output. The summary is JSON if
  /// RunOptions::json is set, otherwise text. If RunOptions::quiet is set, neither warnings nor a text
  /// summary are printed. Throws std::runtime_error if standard output cannot be written.
  ///
  /// is_one_of_several: whether the run has several worlds; a text summary then begins with the name of its
  /// world
  void print_summary(bool is_one_of_several) const;
  /// Calls Observer::after_summary() of all observers, for example to finish slow work.
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
