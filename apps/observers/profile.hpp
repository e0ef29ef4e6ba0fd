#pragma once

#include "apps/observers/observer.hpp"
#include "apps/per_thread.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {

/// The first bytes of every profile.
inline constexpr std::string_view k_profile_mark = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";

/// The ticks (simulation steps) that a profile contains, counted from 1, and limits on the size of its file.
struct ProfileLimits {
  std::uint64_t first_tick = 1;                 ///< first tick in the profile
  std::uint64_t last_tick = ~std::uint64_t{0};  ///< last tick in the profile
  /// Largest number of tasks in the file, about 100 bytes each. If a tick has more tasks than fit into the
  /// rest of this number, the tick is written without its tasks.
  std::size_t most_tasks = 1'000'000;
  /// Largest number of ticks in the file, about 1 kB each. Later ticks are omitted.
  std::size_t most_ticks = 20'000;
};

/// Writes the timing of a run in the Trace Event Format, which the trace viewers of browsers read. One track
/// shows the ticks (simulation steps) and their phases, such as sense and move. For each worker thread, a
/// track shows its tasks (batches of robots). Ranks are processes, or groups of threads, that each compute
/// some of the robots; with several ranks, there is also a track for each rank. Counters show memory and
/// robots.
///
/// file    the file is complete JSON after each tick: it can be read during the run, and after the program
///         was killed
/// tasks   the argument `task` of a task is its index in its parallel loop; in the sense phase, tasks are
///         batches of neighbouring robots, in the order of the tiles (squares of the world). A phase may run
///         several parallel loops
/// ranks   in each tick, the track of a rank shows the times that the rank spent in the phases sense, actuate
///         and decide for its own robots. The phase sense is drawn at the time at which it began on rank 0,
///         because the clocks of processes differ
/// load    the argument `imbalance` of a phase is the time that the busiest worker spent in tasks, divided by
///         the mean over all workers (1: equal work; the number of threads: one worker did everything);
///         `busy_us` is the time of all workers together, microseconds. Both are absent if the phase ran no
///         task
/// errors  the constructor throws OutputError if the file cannot be opened; observe() throws
///         std::runtime_error if writing to the file fails
class Profile : public Observer, public TickWatcher {
 public:
  Profile(const std::filesystem::path& file, const Simulation& simulation, const ProfileLimits& limits);

  void phase(std::optional<Phase> phase) override;
  void task(std::size_t index, bool begins) override;
  TickWatcher* tick_watcher() override { return this; }

  /// Writes the tick that has just ended, if the profile is to contain this tick. Does nothing before the
  /// first tick.
  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }

  /// Returns a line that states which ticks and tasks were omitted because of the limits; empty: none.
  std::string warning() const override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Span {
    Clock::time_point begin, end;
  };
  struct Task {
    Span span;
    std::size_t index;
    Phase phase;
  };
  /// The tasks that one thread has run in this tick. Each thread writes only its own track. The thread that
  /// calls observe() reads all tracks between loops.
  struct Track {
    Clock::time_point begin;
    std::vector<Task> tasks;
    bool named = false;
  };

  void add(const std::string& event);
  void add_name(int group, std::size_t track, const std::string& name);
  void add_span(const std::string& name, const Span& span, int group, std::size_t track,
                const std::string& arguments);
  void add_counter(const std::string& name, Clock::time_point at, std::uint64_t value);
  void write_tasks(std::span<const RankWork> ranks);
  void write_rank(std::size_t rank, const RankWork& work);
  /// Returns the arguments `imbalance` and `busy_us` of a phase as JSON; empty if the phase ran no task.
  std::string load(Phase phase) const;
  /// Writes the pending events over the closing brackets of the file, and then the brackets again, so that
  /// the file is complete.
  void flush();

  std::filesystem::path file_;
  std::ofstream stream_;
  std::streamoff end_ = 0;  // position of the next event, where the closing brackets are now
  std::string pending_;
  std::vector<std::pair<std::string, std::string>> about_;
  bool first_event_ = true;

  ProfileLimits limits_;
  std::size_t tasks_left_;  // number of tasks that may still be written
  std::size_t ticks_left_;  // number of ticks that may still be written
  std::string left_out_;    // what was omitted because of the limits; empty: nothing

  Clock::time_point start_ = Clock::now();
  std::uint64_t start_tick_;
  std::uint64_t tick_;      // the last tick that began
  bool recording_ = false;  // whether the profile contains this tick
  bool ended_ = false;      // whether most_ticks is reached
  std::optional<Phase> current_;
  std::array<Span, k_phases> phases_{};
  unsigned threads_;
  PerThread<Track> tracks_;
};

/// Returns the output of a run (an object with command-line options, see RunOutput) that writes a Profile. It
/// adds the options --profile and --profile-ticks to the command line, and writes the profile to the file
/// that --profile names. Without --profile, nothing is written.
std::unique_ptr<RunOutput> profile_output();

}  // namespace troupe::apps
