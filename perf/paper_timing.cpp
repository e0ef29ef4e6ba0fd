#include "perf/paper_timing.hpp"

#include "apps/run/phase_clock.hpp"
#include "base/diagnostics.hpp"
#include "engine/observing/frame.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "partition/simd_target.hpp"

#ifdef TROUPE_HAS_RENDER
#include "render/draw.hpp"
#endif

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace troupe::perf {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds k_frame_period{100};
// To measure the phases of a tick, the clock is read five times per tick. This takes about 0.2 microseconds,
// which is too much for small worlds, in which a tick takes 2 microseconds. Phases are therefore measured
// only in worlds with this many robots or more.
constexpr std::size_t k_least_robots_with_phases = 100;

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

/// Draws a picture after a tick if at least 0.1 s of wall time has passed since the start of the previous
/// picture. If drawing the previous picture took longer than 0.05 s, a pause of the same length must also
/// have passed since its end, so that the simulation gets at least half of the time.
class Camera {
 public:
#ifdef TROUPE_HAS_RENDER
  explicit Camera(const engine::World& world) : world_(world), painter_(engine::make_scene(world)) {
    draw();  // loads Mesa and the driver before timing
    frames_ = 0;
  }
  void start() { next_ = Clock::now() + k_frame_period; }
  void look() {
    const auto now = Clock::now();
    if (now < next_) return;
    draw();
    next_ = std::max(now + k_frame_period, now + 2 * (Clock::now() - now));
  }

 private:
  void draw() {
    painter_.draw(engine::make_frame(world_), {.camera = {.perspective = true, .pitch = 0.87}});
    ++frames_;
  }

  const engine::World& world_;
  render::Painter painter_;
  Clock::time_point next_;
#else
  explicit Camera(const engine::World&) {
    throw std::runtime_error("this build cannot draw pictures: it was configured with TROUPE_RENDER=OFF");
  }
  void start() {}
  void look() {}

 private:
#endif
 public:
  std::size_t frames() const { return frames_; }

 private:
  std::size_t frames_ = 0;
};

double share(const apps::PhaseClock& phases, engine::Phase phase) {
  const double sum = std::accumulate(phases.seconds().begin(), phases.seconds().end(), 0.0);
  return sum > 0 ? phases.seconds()[static_cast<std::size_t>(phase)] / sum : 0;
}

engine::WorldSpec load(const Scene& scene, const engine::Registry& registry) {
  Diagnostics diagnostics;
  engine::WorldSpec spec = worldio::load_world(scene.world, registry, scene.load, diagnostics);
  diagnostics.throw_if_errors();
  if (scene.grid) spec.ranging = engine::RangingEngine::grid;
  return spec;
}

std::unique_ptr<engine::World> make_world(const engine::WorldSpec& spec, unsigned threads,
                                          const engine::Registry& registry) {
  Diagnostics diagnostics;
  auto world =
      std::make_unique<engine::World>(spec, registry, engine::WorldOptions{.threads = threads}, diagnostics);
  diagnostics.throw_if_errors();
  return world;
}

/// Runs one repetition: steps the world and stores the measurements in `timing`. The wall time is appended;
/// the other values replace those of the previous repetition.
void time_steps(engine::World& world, Timing& timing, const engine::Registry& registry) {
  const Run& run = timing.run;
  const std::unique_ptr<Watcher> watcher = make_watcher(run.watch, world, registry);
  std::unique_ptr<Camera> camera;
  if (run.frames) camera = std::make_unique<Camera>(world);
  apps::PhaseClock phases;
  const bool with_phases = world.robots() >= k_least_robots_with_phases;
  if (with_phases) world.on_phase([&phases](std::optional<engine::Phase> phase) { phases(phase); });
  const std::uint64_t beams = world.counters().beams;
  const std::uint64_t rounds = world.counters().conflict_rounds;

  const auto start = Clock::now();
  if (camera) {
    camera->start();
    for (std::uint64_t i = 0; i < timing.ticks; ++i) {
      world.step();
      camera->look();
    }
  } else if (watcher) {
    for (std::uint64_t i = 0; i < timing.ticks; ++i) {
      world.step();
      watcher->look();
    }
    watcher->finish();
  } else {
    for (std::uint64_t i = 0; i < timing.ticks; ++i) world.step();
  }
  timing.wall_s.push_back(seconds(Clock::now() - start));

  world.on_phase(nullptr);
  const auto ticks = static_cast<double>(timing.ticks);
  timing.robots = world.robots();
  timing.beams_per_tick = static_cast<double>(world.counters().beams - beams) / ticks;
  timing.rounds_per_tick = static_cast<double>(world.counters().conflict_rounds - rounds) / ticks;
  timing.stalled_share =
      static_cast<double>(world.view().counts().stalled) / static_cast<double>(world.robots());
  timing.move_share = share(phases, engine::Phase::move);
  timing.frames = camera ? camera->frames() : 0;
}

/// A computation that uses only registers, so that threads share nothing.
double compute(std::uint64_t rounds) {
  std::uint64_t bits = rounds;
  double sum = 0;
  for (std::uint64_t i = 0; i < rounds; ++i) {
    bits ^= bits << 13;  // xorshift64, Marsaglia 2003
    bits ^= bits >> 7;
    bits ^= bits << 17;
    sum += std::sqrt(static_cast<double>(bits >> 11));
  }
  return sum;
}

double probe_rounds_s(unsigned threads, std::uint64_t rounds) {
  std::atomic<double> sink = 0;  // keeps the compiler from removing the computation
  const auto start = Clock::now();
  {
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i) others.emplace_back([&sink, rounds] { sink = compute(rounds); });
    sink = compute(rounds);
  }
  return seconds(Clock::now() - start);
}

}  // namespace

double Timing::ns(double s) const {
  return 1e9 * s / (static_cast<double>(robots) * static_cast<double>(ticks));
}

double Timing::times_real_time(double s) const { return static_cast<double>(ticks) * tick_s / s; }

double probe_s(unsigned threads) {
  // The computation takes long enough that the start of a thread (about 50 microseconds) is negligible.
  static const std::uint64_t rounds = [] {
    std::uint64_t n = 1 << 20;
    while (probe_rounds_s(1, n) < 0.1) n *= 2;
    return n;
  }();
  return probe_rounds_s(threads, rounds);
}

CaseTiming time_case(const Case& one, std::size_t repeat, const engine::Registry& registry,
                     const std::function<void(const std::string&)>& progress) {
  std::map<std::string, engine::WorldSpec> specs;
  std::vector<std::unique_ptr<engine::World>> worlds(one.runs.size());
  CaseTiming out{one.table, {}, {}};
  for (const Run& run : one.runs) {
    auto [spec, fresh] = specs.try_emplace(run.scene.name);
    if (fresh) {
      progress(fmt::format("{}: loading", run.scene.name));
      spec->second = load(run.scene, registry);
    }
    Timing timing{.run = run, .tick_s = spec->second.tick_s};
    timing.ticks = std::max<std::uint64_t>(1, engine::ticks_until(run.scene.for_s, timing.tick_s));
    timing.hash_tick = engine::ticks_until(run.scene.skip_s, timing.tick_s) + timing.ticks;
    out.timings.push_back(std::move(timing));
  }
  const std::string simd = partition::simd_target();
  for (std::size_t repetition = 0; repetition < repeat; ++repetition) {
    for (std::size_t r = 0; r < one.runs.size(); ++r) {
      const Run& run = one.runs[r];
      partition::use_simd_target(run.simd.empty() ? simd : run.simd);
      Timing& timing = out.timings[r];
      std::unique_ptr<engine::World>& world = worlds[r];
      progress(fmt::format("{}: {} thread{}{}, {} of {}", run.scene.name, run.threads,
                           run.threads > 1 ? "s" : "", with_text(run), repetition + 1, repeat));
      if (!world) {
        world = make_world(specs.at(run.scene.name), run.threads, registry);
        while (world->tick() + timing.ticks < timing.hash_tick) world->step();
      }
      time_steps(*world, timing, registry);
      if (world->tick() == timing.hash_tick) {
        const std::uint64_t hash = world->hashes().state;
        if (repetition > 0 && hash != timing.hash) timing.repeatable = false;
        if (repetition == 0) timing.hash = hash;
      }
      if (!(run.scene.skip_s > 0)) world.reset();
    }
    for (const Run& run : one.runs)
      if (out.probe_s[run.threads].size() == repetition)
        out.probe_s[run.threads].push_back(probe_s(run.threads));
  }
  partition::use_simd_target(simd);
  return out;
}

std::string with_text(const Run& run) {
  if (run.frames) return ", frames";
  if (!run.simd.empty()) return fmt::format(", {}", run.simd);
  return run.watch == Watch::nothing ? std::string() : fmt::format(", {}", watch_name(run.watch));
}

std::optional<double> watching_cost(const CaseTiming& one, const Timing& watched) {
  const auto base = std::ranges::find_if(one.timings, [&](const Timing& other) {
    return other.run.threads == watched.run.threads && other.run.watch == Watch::nothing && !other.run.frames;
  });
  if (watched.run.watch == Watch::nothing || base == one.timings.end()) return std::nullopt;
  std::vector<double> costs;
  for (std::size_t i = 0; i < watched.wall_s.size(); ++i)
    costs.push_back(watched.wall_s[i] / base->wall_s[i] - 1);
  return median(std::move(costs));
}

Result<> can_draw() {
#ifdef TROUPE_HAS_RENDER
  try {
    render::draw({}, {}, {.width = 16, .height = 16, .region = Box::around(Vec2::Zero(), 1)});
    return {};
  } catch (const std::exception& error) {
    return Error{error.what()};
  }
#else
  return Error{"this build cannot draw pictures: it was configured with TROUPE_RENDER=OFF"};
#endif
}

double minimum(const std::vector<double>& values) { return *std::ranges::min_element(values); }
double maximum(const std::vector<double>& values) { return *std::ranges::max_element(values); }

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

}  // namespace troupe::perf
