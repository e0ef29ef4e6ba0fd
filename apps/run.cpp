#include "apps/run.hpp"

#include "apps/checkpointing.hpp"
#include "apps/outputs.hpp"
#include "apps/phase_clock.hpp"
#include "apps/profile.hpp"
#include "apps/progress.hpp"
#include "apps/recorder.hpp"
#include "apps/report.hpp"
#include "apps/tables.hpp"
#include "base/diagnostics.hpp"
#include "engine/ticks.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The one thing a signal handler may do is to set a flag.
std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// From here on Ctrl-C and SIGTERM end the run after the current tick; a second one ends it at once. A file
/// that grows beyond what the system allows is an error in writing it, not the end of the program.
void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = true; };
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

void print_options(const Report& report) {
  fmt::print("running\n");
  for (const auto& [key, value] : report.options) fmt::print("  {:<18} {}\n", key, value);
  fmt::print("  {:<18} {:.10g}\n", "until_s", report.end_s);
  std::fflush(stdout);
}

/// What the run writes tick by tick.
struct Observers {
  std::vector<std::unique_ptr<Observer>> all;
  Profile* profile = nullptr;         // of them the one that the phases and tasks are told, too
  Observer* checkpointing = nullptr;  // the last of them, so that what is saved was written by all others

  void observe(const Simulation& simulation) const {
    tell(simulation, [&](Observer& observer) { observer.observe(simulation); });
  }
  void finish(const Simulation& simulation) const {
    tell(simulation, [&](Observer& observer) { observer.finish(simulation); });
  }

 private:
  /// A log that cannot be written any more ends the run, but costs no state.
  template <class Tell>
  void tell(const Simulation& simulation, Tell&& each) const {
    try {
      for (const auto& observer : all) each(*observer);
    } catch (...) {
      save_at_least(simulation);
      throw;
    }
  }
  void save_at_least(const Simulation& simulation) const {
    try {
      if (checkpointing) checkpointing->finish(simulation);
    } catch (const std::runtime_error&) {  // what went wrong first is told
    }
  }
};

/// Opens the files: before the first tick, so that one that cannot be written costs no run.
Observers make_observers(const RunOptions& options, Simulation& simulation) {
  Observers observers;
  std::optional<Measures> measures;  // before any file: what is wrong with them is bad input
  if (!options.measures.empty()) measures.emplace(simulation, options.measure);
  if (auto recorder = make_recorder(options, simulation)) observers.all.push_back(std::move(recorder));
  if (!options.hash_log.empty())
    observers.all.push_back(std::make_unique<HashLog>(options.hash_log, simulation));
  if (!options.profile.empty()) {
    auto profile = std::make_unique<Profile>(options.profile, simulation, options.profile_limits);
    observers.profile = profile.get();
    observers.all.push_back(std::move(profile));
  }
  if (measures) {
    const double every_s = options.measure_every_s.value_or(simulation.world().spec().measure_every_s);
    const std::uint64_t every = engine::period_ticks(every_s, simulation.tick_s());
    observers.all.push_back(
        std::make_unique<MeasuresTable>(options.measures, simulation, std::move(*measures), every));
  }
  if (!options.events.empty())
    observers.all.push_back(std::make_unique<EventsTable>(options.events, simulation));
  if (!options.checkpoint.empty()) {
    std::vector<Observer*> others;
    for (const auto& observer : observers.all) others.push_back(observer.get());
    observers.all.push_back(std::make_unique<Checkpointing>(options.checkpoint, options.checkpoint_every_s,
                                                            simulation, std::move(others)));
    observers.checkpointing = observers.all.back().get();
  }
  return observers;
}

/// Steps to the end, to a signal, or until `is_over`; fills in what a run measures.
void step_to_end(Simulation& simulation, const Observers& observers, const std::function<bool()>& is_over,
                 bool show_progress, Report& report) {
  Profile* const profile = observers.profile;
  PhaseClock phases;
  simulation.on_phase([&phases, profile](std::optional<Phase> phase) {
    phases(phase);
    if (profile) profile->phase(phase);
  });
  if (profile) simulation.on_task([profile](std::size_t task, bool begins) { profile->task(task, begins); });
  const std::uint64_t ticks = engine::ticks_until(report.end_s, simulation.tick_s());
  observers.observe(simulation);
  {
    Progress progress(simulation.tick(), ticks, simulation.tick_s(), show_progress);
    const auto start = Clock::now();
    while (simulation.tick() < ticks && !stop_requested && !is_over()) {
      simulation.step();
      observers.observe(simulation);
      progress.update(simulation.tick());
    }
    report.wall_s = seconds_since(start);
  }
  observers.finish(simulation);
  simulation.on_phase(nullptr);
  simulation.on_task(nullptr);
  report.phase_s = phases.seconds();
  report.stopped = simulation.tick() < ticks;
  report.statistics = simulation.statistics();
  report.hashes = simulation.hashes();
}

/// What has to be right before anything is loaded; and, since the world may name a recording, once it is.
void check_files(const RunOptions& options, const std::filesystem::path& recording) {
  const std::filesystem::path resumed_from = options.is_checkpoint ? options.world : "";
  check_checkpoint(options.checkpoint, resumed_from, options.force);
  const bool goes_on = same_file(options.checkpoint, resumed_from);
  check_outputs(options.world, options.is_checkpoint ? "the checkpoint" : "the world",
                {options.hash_log, options.snapshot, options.profile, recording, options.measures,
                 options.events, goes_on ? std::filesystem::path() : options.checkpoint});
}

Simulation load(const RunOptions& options) {
  const SimulationOptions& simulation = options.simulation;
  if (options.is_checkpoint)
    return Simulation::resume(options.world, {.threads = simulation.threads,
                                              .tile_size_m = simulation.tile_size_m,
                                              .set = simulation.set,
                                              .across_versions = options.across_versions,
                                              .plugin_path = plugin_path(simulation.plugin_path),
                                              .across_plugins = options.across_plugins});
  return Simulation(options.world, with_environment(simulation));
}

ExitCode run_checked(const RunOptions& options) {
  const auto start = Clock::now();
  check_files(options, options.record);
  Simulation simulation = load(options);
  Report report;
  report.load_s = seconds_since(start);
  if (!options.quiet)
    for (const std::string& warning : simulation.warnings()) fmt::print(stderr, "{}\n", warning);
  report.options = simulation.effective_options();
  report.world = report.options.front().second;
  report.first_tick = simulation.tick();
  report.title = simulation.title();
  report.tick_s = simulation.tick_s();
  report.end_s = end_of(options, simulation);
  if (engine::ticks_until(report.end_s, report.tick_s) < report.first_tick)
    throw InputError(fmt::format("{}: error: the run is at {:g} s already: {:g} s lies before that",
                                 options.world.string(), simulation.time_s(), report.end_s));
  report.threads = simulation.threads();

  stop_on_signals();
  if (!options.snapshot.empty()) rehearse_snapshot(simulation, options.snapshot);
  check_files(options, recording_file(options, simulation));
  const Observers observers = make_observers(options, simulation);

  if (!options.quiet && !options.json) print_options(report);
  const auto is_over = [&] { return options.wall_limit_s && seconds_since(start) >= *options.wall_limit_s; };
  step_to_end(simulation, observers, is_over, !options.quiet, report);
  if (const Profile* profile = observers.profile; profile && !profile->left_out().empty() && !options.quiet)
    fmt::print(stderr, "{}: warning: left out to keep it small: {}; --profile-ticks chooses other ticks\n",
               options.profile.string(), profile->left_out());
  report.peak_rss_bytes = peak_rss_bytes();
  report.checkpoint = options.checkpoint.string();

  if (options.json)
    fmt::print("{}", summary_json(report));
  else if (!options.quiet)
    fmt::print("{}", summary_text(report));
  if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
  // Last, so that a picture that fails takes no numbers with it.
  if (!options.snapshot.empty()) simulation.snapshot(options.snapshot, options.width, options.height);
  return report.stopped ? k_stopped : k_finished;
}

}  // namespace

ExitCode run(const RunOptions& options) {
  try {
    return run_checked(options);
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return k_bad_input;
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return k_bad_input;
  }
}

}  // namespace troupe::apps
