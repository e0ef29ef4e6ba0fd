#pragma once

#include <chrono>
#include <string>

namespace troupe::apps {

/// The text of a progress bar, without control characters, for a run from world time `begin_s` to `end_s`
/// that has reached `now_s` > `begin_s`, s. elapsed_s: wall time since the start, s.
std::string progress_text(double begin_s, double now_s, double end_s, double elapsed_s);

/// A progress bar on standard error, which is redrawn up to five times per second and erased at the end.
/// Nothing is drawn if standard error is not a terminal, because the bar would clutter a log file, or if the
/// run is expected to take less than two seconds.
class Progress {
 public:
  Progress(double begin_s, double end_s, bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(double now_s);

 private:
  using Clock = std::chrono::steady_clock;
  double begin_s_;
  double end_s_;
  bool visible_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_;
};

}  // namespace troupe::apps
