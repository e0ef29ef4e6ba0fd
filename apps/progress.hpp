#pragma once

#include <chrono>
#include <string>

namespace troupe::apps {

/// The text of a progress bar, without control characters, for work from `begin_s` to `end_s` that has
/// reached `now_s` > `begin_s`, all in world time; `elapsed_s` is the wall time since its start.
std::string progress_text(double begin_s, double now_s, double end_s, double elapsed_s);

/// A progress bar on standard error, redrawn up to five times a second and erased at the end. Draws nothing
/// if standard error is not a terminal, since it would clutter a log, or if the work is expected to take less
/// than two seconds.
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
