#include "apps/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace troupe::apps {
namespace {

constexpr std::chrono::milliseconds k_period{200};
constexpr std::size_t k_width = 28;
constexpr const char* k_wipe = "\r\x1b[K";

std::string duration(double seconds) {
  const auto s = static_cast<std::uint64_t>(std::ceil(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

}  // namespace

std::string progress_text(std::uint64_t first, std::uint64_t tick, std::uint64_t ticks, double tick_s,
                          double elapsed_s) {
  const double share = static_cast<double>(tick) / static_cast<double>(ticks);
  const double time_s = static_cast<double>(tick) * tick_s;
  const auto done = static_cast<double>(tick - first);
  const double here_s = done * tick_s;
  std::string bar(static_cast<std::size_t>(share * k_width), '=');
  if (bar.size() < k_width) bar += '>';
  bar.resize(k_width, ' ');
  return fmt::format("[{}] {:3.0f} %  {:.1f} of {:.1f} s  {:.1f} x real time  {} left", bar, 100 * share,
                     time_s, static_cast<double>(ticks) * tick_s, elapsed_s > 0 ? here_s / elapsed_s : 0.0,
                     duration(elapsed_s * static_cast<double>(ticks - tick) / done));
}

Progress::Progress(std::uint64_t first, std::uint64_t ticks, double tick_s, bool wanted)
    : first_(first),
      ticks_(ticks),
      tick_s_(tick_s),
      visible_(wanted && ticks > 0 && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (drawn_) std::fputs(k_wipe, stderr);
}

void Progress::update(std::uint64_t tick) {
  if (!visible_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + k_period;
  drawn_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  fmt::print(stderr, "{}{}", k_wipe, progress_text(first_, tick, ticks_, tick_s_, elapsed_s));
  std::fflush(stderr);
}

}  // namespace troupe::apps
