#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace troupe::apps {

/// What a progress bar says, without its line control; `elapsed_s` is wall time since the tick `first`, and
/// at least one tick of those until `ticks` is done.
std::string progress_text(std::uint64_t first, std::uint64_t tick, std::uint64_t ticks, double tick_s,
                          double elapsed_s);

/// A bar on standard error that redraws itself a few times a second and wipes itself off in the end. Draws
/// nothing where standard error is not a terminal: a log has no use for it.
class Progress {
 public:
  Progress(std::uint64_t first, std::uint64_t ticks, double tick_s, bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::uint64_t tick);

 private:
  using Clock = std::chrono::steady_clock;
  std::uint64_t first_;
  std::uint64_t ticks_;
  double tick_s_;
  bool visible_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_;
};

}  // namespace troupe::apps
