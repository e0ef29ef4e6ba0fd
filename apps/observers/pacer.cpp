#include "apps/observers/pacer.hpp"

#include <algorithm>
#include <thread>
#include <utility>

namespace troupe::apps {
namespace {

// Longest time between two calls of is_over(), so that Ctrl-C takes effect soon.
constexpr std::chrono::milliseconds k_nap{50};
constexpr std::chrono::seconds k_most_behind{1};  // longest delay that a run catches up
constexpr double k_longest_s = 1e9;               // as nanoseconds, fits into the 64 bits of a duration

}  // namespace

Pacer::Pacer(double rate, std::function<bool()> is_over) : rate_(rate), is_over_(std::move(is_over)) {}

void Pacer::observe(const Simulation& simulation) {
  const auto now = Clock::now();
  if (!begun_) {
    begun_ = true;
    begun_at_s_ = simulation.time_s();
    begun_at_ = now;
    return;
  }
  const std::chrono::duration<double> since_begin(
      std::min(k_longest_s, (simulation.time_s() - begun_at_s_) / rate_));
  const auto due = begun_at_ + std::chrono::duration_cast<Clock::duration>(since_begin);
  if (due + k_most_behind < now) {
    begun_at_s_ = simulation.time_s();
    begun_at_ = now;
  } else if (now < due) {
    wait_until(due);
    waited_s_ += std::chrono::duration<double>(Clock::now() - now).count();
  }
}

void Pacer::wait_until(Clock::time_point due) {
  for (auto now = Clock::now(); now < due && !is_over_(); now = Clock::now())
    std::this_thread::sleep_for(std::min<Clock::duration>(due - now, k_nap));
}

}  // namespace troupe::apps
