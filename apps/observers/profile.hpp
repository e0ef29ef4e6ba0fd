#pragma once

#include "apps/observers/observer.hpp"
#include "apps/per_thread.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/descriptor.hpp"

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

/// The ticks (time steps) that a profile contains, counted from 1, and limits on the size of its file.
struct ProfileLimits {
  std::uint64_t first_tick = 1;                 ///< first tick in the profile
  std::uint64_t last_tick = ~std::uint64_t{0};  ///< last tick in the profile
  /// Largest number of tasks in the file; each takes about 100 bytes. If a tick has more tasks than may still
  /// be written, the tick is written without its tasks.
  std::size_t most_tasks = 1'000'000;
  /// Largest number of ticks in the file; each takes about 1 kB. Later ticks are omitted.
  std::size_t most_ticks = 20'000;
};

/// Writes the timing of a run in the Trace Event Format, which the trace viewers of browsers read. The file
/// has several tracks:
///
/// - One track shows the ticks (time steps) and their phases, such as sense and move.
/// - Each worker thread has a track for its tasks. A task is a part of a parallel loop; in the phase sense,
///   it is a batch of neighbouring robots. The argument `task` is the index of the task in its loop. A phase
///   may run several loops.
/// - A rank is a process, or a group of threads, that computes some of the robots. With several ranks, each
///   rank has a track. The track shows how long the phases sense, actuate and decide took in each tick for
///   the robots of the rank. It shows these three durations one after the other, from the time at which the
///   phase sense began on rank 0. The true start times are unknown, because the clocks of processes differ.
///
/// Counters show memory and numbers of robots. If the robots are distributed among the ranks
/// (SimulationOptions::distribute), the only counter is the resident memory of rank 0, because the others
/// need the robots of all ranks. Each phase of a tick has two arguments, unless it ran no task:
///
/// - `busy_us` is the time that all workers together spent in tasks, microseconds.
/// - `imbalance` is the time of the busiest worker, divided by the mean over all workers. It is 1 if the work
///   was equal, and the number of workers if one worker did everything.
///
/// After each tick, the file is complete JSON, so it can be read during the run, and after the program was
/// killed. The constructor throws OutputError if the file cannot be opened. observe() throws
/// std::runtime_error if writing fails.
class Profile : public Observer, public TickWatcher {
 public:
  Profile(const std::filesystem::path& file, const Simulation& simulation, const ProfileLimits& limits);

  void phase(std::optional<Phase> phase) override;
  void task(std::size_t index, bool begins) override;
  TickWatcher* tick_watcher() override { return this; }

  /// Writes the tick that has just ended, if the limits of the profile (ProfileLimits) include this tick.
  /// Does nothing before the first tick.
  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }

  /// Returns one line that states which ticks and tasks were omitted because of the limits, or that the
  /// limits exclude all ticks of the run. The text is empty if no tick and no task was omitted to keep the
  /// file small.
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
  /// The tasks that one thread has run in this tick. During a parallel loop, each thread writes only its own
  /// track. Between loops, the thread that calls observe() reads all tracks.
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
  /// Appends the pending events to the file. They overwrite the closing brackets at its end, which are then
  /// written again, so that the file is complete.
  void flush();

  std::filesystem::path file_;
  worldio::Descriptor lock_;
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

/// Returns the RunOutput for a profile (Profile). A RunOutput is one output of a run, together with its
/// command-line options. The option --profile names the file, and --profile-ticks selects the ticks. Without
/// --profile, nothing is written.
std::unique_ptr<RunOutput> profile_output();

}  // namespace troupe::apps
