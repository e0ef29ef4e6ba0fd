#pragma once

#include <chrono>
#include <string>

namespace troupe::apps {

/// What a progress bar says, without its line control, of work that goes from `begin_s` to `end_s`, world
/// time, and stands at `now_s`, beyond `begin_s`; `elapsed_s` is wall time since its beginning.
std::string progress_text(double begin_s, double now_s, double end_s, double elapsed_s);

/// A bar on standard error that redraws itself a few times a second and wipes itself off in the end. Draws
/// nothing where standard error is not a terminal, since a log has no use for it, and nothing of work that
/// seems to take less than two seconds.
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
