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
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {

/// The first bytes of every profile.
inline constexpr std::string_view k_profile_mark = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";

/// Which ticks a profile shows, and how much of them at most.
struct ProfileLimits {
  std::uint64_t first_tick = 1;
  std::uint64_t last_tick = ~std::uint64_t{0};
  /// Of tasks, some 100 bytes each. A tick whose tasks would be too many is shown without them.
  std::size_t most_tasks = 1'000'000;
  /// Of ticks, some kilobyte each.
  std::size_t most_ticks = 20'000;
};

/// Where the time of a run goes, in the Trace Event Format that browsers' trace viewers open: a track with
/// the ticks and their phases, a track a worker with its tasks (batches of robots), counters of memory and
/// robots.
///
/// file    complete after each tick: it can be read while the run goes on, and after it was killed
/// tasks   their argument is their index in their loop; in the sense phase batches of robots that are
///         neighbours, in the order of the tiles. A phase may run several loops
/// load    a phase's argument `imbalance` is the busiest worker's time in tasks by the mean of all `threads`
///         workers (1: perfect; `threads`: one did everything); left out where a phase ran no task
/// errors  OutputError when the file cannot be opened, std::runtime_error when it cannot be written
class Profile : public Observer, public TickWatcher {
 public:
  Profile(const std::filesystem::path& file, const Simulation& simulation, const ProfileLimits& limits);

  void phase(std::optional<Phase> phase) override;
  void task(std::size_t index, bool begins) override;
  TickWatcher* tick_watcher() override { return this; }

  /// Writes the tick that has just ended, if one has.
  void observe(const Simulation& simulation) override;

  /// What the limits left out.
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
  /// What one thread has done in this tick. Threads write their own only, and the caller's thread reads them
  /// between loops.
  struct Track {
    Clock::time_point begin;
    std::vector<Task> tasks;
    bool named = false;
  };

  void add(const std::string& event);
  void add_span(const std::string& name, const Span& span, std::size_t track, const std::string& arguments);
  void add_counter(const std::string& name, Clock::time_point at, std::uint64_t value);
  void write_tasks();
  std::string load(Phase phase) const;
  /// Replaces the end of the file.
  void flush();

  std::filesystem::path file_;
  std::ofstream stream_;
  std::streamoff end_ = 0;  // where the next event goes: the closing brackets stand there
  std::string pending_;
  std::vector<std::pair<std::string, std::string>> about_;
  bool first_event_ = true;

  ProfileLimits limits_;
  std::size_t tasks_left_;
  std::size_t ticks_left_;
  std::string left_out_;

  Clock::time_point start_ = Clock::now();
  std::uint64_t start_tick_;
  std::uint64_t tick_;      // the last that began
  bool recording_ = false;  // this tick
  bool ended_ = false;      // no tick is recorded any more, though more were wanted
  std::optional<Phase> current_;
  std::array<Span, k_phases> phases_{};
  unsigned threads_;
  PerThread<Track> tracks_;
};

/// --profile and --profile-ticks.
std::unique_ptr<RunOutput> profile_output();

}  // namespace troupe::apps
