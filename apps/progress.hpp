#pragma once

#include <chrono>

namespace troupe::apps {

/// A progress bar on standard error. It is redrawn up to five times per second and erased at the end. Nothing
/// is drawn if standard error is not a terminal. The bar also does not appear while the run is expected to
/// take less than two seconds of wall time in total.
class Progress {
 public:
  /// begin_s, end_s: simulated times at which the run begins and ends, s
  /// wanted: whether to draw the bar
  Progress(double begin_s, double end_s, bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(double now_s);  ///< now_s: simulated time that the run has reached, s

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
