#include "apps/progress.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

namespace troupe::apps {
namespace {

constexpr std::chrono::milliseconds k_period{200};
constexpr double k_least_shown_s = 2;
constexpr std::size_t k_width = 28;
constexpr const char* k_wipe = "\r\x1b[K";

std::string duration(double seconds) {
  const auto s = static_cast<std::uint64_t>(std::ceil(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

/// Returns the text of a progress bar, without control characters: the bar, the simulated time, the mean
/// speed and the expected remaining wall time.
///
/// begin_s, end_s: simulated times at which the run begins and ends, s; `end_s` must exceed `begin_s`
/// now_s: simulated time that the run has reached, s; must exceed `begin_s`
/// elapsed_s: wall time since the run began, s
std::string progress_text(double begin_s, double now_s, double end_s, double elapsed_s) {
  const double share = std::clamp((now_s - begin_s) / (end_s - begin_s), 0.0, 1.0);
  std::string bar(static_cast<std::size_t>(share * k_width), '=');
  if (bar.size() < k_width) bar += '>';
  bar.resize(k_width, ' ');
  return fmt::format("[{}] {:3.0f} %  {:.1f} of {:.1f} s  {} x real time  {} left", bar, 100 * share, now_s,
                     end_s, four_digits(elapsed_s > 0 ? (now_s - begin_s) / elapsed_s : 0.0),
                     duration(elapsed_s * (1 - share) / share));
}

}  // namespace

Progress::Progress(double begin_s, double end_s, bool wanted)
    : begin_s_(begin_s), end_s_(end_s), visible_(wanted && end_s > begin_s && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (drawn_) std::fputs(k_wipe, stderr);
}

void Progress::update(double now_s) {
  if (!visible_ || now_s <= begin_s_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + k_period;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double expected_s = elapsed_s * (end_s_ - begin_s_) / (now_s - begin_s_);
  if (!drawn_ && (now < start_ + k_period || expected_s < k_least_shown_s)) return;
  drawn_ = true;
  std::fputs((k_wipe + progress_text(begin_s_, now_s, end_s_, elapsed_s)).c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace troupe::apps
