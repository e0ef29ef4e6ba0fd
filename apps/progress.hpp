#pragma once

#include <chrono>
#include <string>

namespace troupe::apps {

/// Returns the text of a progress bar, without control characters: the bar, the simulated time, the mean
/// speed and the expected remaining wall time.
///
/// begin_s, end_s: simulated times at which the run begins and ends, s; `end_s` must exceed `begin_s`
/// now_s: simulated time that the run has reached, s; must exceed `begin_s`
/// elapsed_s: wall time since the run began, s
std::string progress_text(double begin_s, double now_s, double end_s, double elapsed_s);

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
