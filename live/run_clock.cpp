#include "live/run_clock.hpp"

#include "engine/spec/ticks.hpp"
#include "live/request.hpp"
#include "live/view.hpp"
#include "troupe/acts.hpp"
#include "troupe/simulation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace troupe::live {
namespace {

constexpr std::chrono::seconds k_most_behind{1};  // a run that is later than this does not catch up
constexpr std::uint64_t k_most_steps = 1000000000;

std::string expected_rate() {
  return fmt::format("give 0 (as fast as possible), or a multiple of real time from {} to {}", k_least_rate,
                     k_most_rate);
}

}  // namespace

RunClock::RunClock(const Simulation& simulation, double rate) : simulation_(simulation), rate_(rate) {
  if (!is_rate(rate))
    throw std::invalid_argument(fmt::format("the rate of the view is {}: {}", rate, expected_rate()));
}

double RunClock::speed() const { return playing_ ? std::round(reached_ * 100) / 100 : 0; }

void RunClock::play(std::uint64_t ticks) {
  if (!playing_) restart();
  playing_ = true;
  steps_ = ticks;
  until_ = 0;
}

void RunClock::restart() {
  due_ = measured_ = Clock::now();
  measured_s_ = simulation_.time_s();
  if (playing_ && until_ > simulation_.tick()) steps_ = until_ - simulation_.tick();
}

bool RunClock::obey(const Request& request) {
  if (request.what() == "play") {
    play(0);
  } else if (request.what() == "pause") {
    // Pauses after the next tick, because the hash log line is computed then. At a low rate, this tick would
    // be due much later.
    if (playing_) {
      play(1);
      due_ = Clock::now();
    }
  } else if (request.what() == "step") {
    const std::uint64_t ticks = request.has("ticks") ? request.whole("ticks", 1, k_most_steps) : 1;
    play(steps_ + ticks);  // in addition to the ticks that remain of an earlier request
  } else if (request.what() == "until") {
    const double time_s = request.number("time_s", 0, engine::k_most_seconds);
    const std::uint64_t end = engine::ticks_until(time_s, simulation_.tick_s());
    if (end <= simulation_.tick())
      throw ActRefused(
          fmt::format("\"time_s\" is {:.10g} s, but the world is already at {:.10g} s: give a later time",
                      time_s, simulation_.time_s()));
    play(end - simulation_.tick());
    until_ = end;
  } else if (request.what() == "rate") {
    const double rate = request.number("rate", 0, k_most_rate);
    if (!is_rate(rate)) throw ActRefused(fmt::format("\"rate\" is {}: {}", rate, expected_rate()));
    rate_ = rate;
    due_ = Clock::now();
  } else {
    return false;
  }
  return true;
}

void RunClock::begin_tick() {
  if (rate_ == 0) return;
  const auto now = Clock::now();
  const auto tick = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(simulation_.tick_s() / rate_));
  due_ = due_ + k_most_behind < now ? now + tick : due_ + tick;
}

bool RunClock::end_tick() {
  if (steps_ == 0 || --steps_ > 0) return false;
  playing_ = false;
  return true;
}

bool RunClock::measure_speed() {
  const std::chrono::duration<double> since = Clock::now() - measured_;
  if (since.count() < 0.5) return false;
  reached_ = (simulation_.time_s() - measured_s_) / since.count();
  measured_ = Clock::now();
  measured_s_ = simulation_.time_s();
  return true;
}

}  // namespace troupe::live
