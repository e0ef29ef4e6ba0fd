#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/load_clock.hpp"
#include "apps/run/phase_clock.hpp"
#include "apps/run/report.hpp"
#include "apps/run/run_options.hpp"
#include "troupe/session.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace troupe::apps {

class Pacer;

/// One world of a run, loaded. Its owner steps it.
class WorldRun {
 public:
  /// Loads the world, or resumes it, and tells its warnings. `options` names one world, and its outputs as
  /// they are. Throws InputError.
  explicit WorldRun(RunOptions options);
  ~WorldRun();
  WorldRun(const WorldRun&) = delete;
  WorldRun& operator=(const WorldRun&) = delete;

  const RunOptions& options() const { return options_; }
  const Simulation& simulation() const { return simulation_; }
  /// Its options, with the names of files that the world itself gives. Throws InputError.
  const RunOptions& take_names_from_world();

  /// Before the first tick: what cannot be drawn, measured or written costs no run. `is_over` tells a
  /// waiting run to end.
  void rehearse();
  void open_outputs(std::function<bool()> is_over);
  /// Tells the time in lines of its own, beside which a progress bar has no place.
  bool tells_time() const;
  /// What is about to run, on standard output.
  void print_options() const;

  /// Observes the tick it stands at; then a tick each time.
  void begin();
  void step();
  bool is_done() const { return simulation_.tick() >= ticks_ || simulation_.stopped(); }
  /// World time at the end of its next tick, s.
  double next_s() const { return static_cast<double>(simulation_.tick() + 1) * simulation_.tick_s(); }
  /// Writes what observers still hold, and fills in the report.
  void finish();
  /// Where another part of the run failed: the state is saved if it was to be, whatever else goes wrong.
  void save_at_least() const;

  const Report& report() const { return report_; }
  /// The summary, on standard output, as text or JSON; `is_one_of_several` says which world it is.
  void print_summary(bool is_one_of_several) const;
  /// What observers do last.
  void after_summary() const;

 private:
  using Clock = std::chrono::steady_clock;

  RunOptions options_;
  Clock::time_point start_ = Clock::now();
  Simulation simulation_;
  std::unique_ptr<SessionReplay> session_;
  Report report_;
  std::uint64_t ticks_ = 0;           // at which it ends
  std::vector<OpenOutput> prepared_;  // outputs that are not open yet
  Observers observers_;
  std::vector<TickWatcher*> watchers_;  // those of them that phases and tasks are told
  const Pacer* pacer_ = nullptr;
  PhaseClock phases_;
  LoadClock load_;
  bool is_intact_ = true;  // false after a step that failed: its state is of no use
};

}  // namespace troupe::apps
