// Measures the time to draw a frame of a film, and the time to draw a picture of a large swarm. The first
// picture of each measurement takes longer and is not counted.
//   build/release/bin/perf_pictures

#include "base/random.hpp"
#include "render/draw.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>

namespace troupe {
namespace {

Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// A regular polygon of 24 corners.
Ring circle(double radius) {
  Ring ring;
  for (int i = 0; i < 24; ++i)
    ring.emplace_back(radius * std::cos(i * k_pi / 12), radius * std::sin(i * k_pi / 12));
  return ring;
}

/// Minibots scattered over 140 x 60 m, with 200 walls between them.
struct Swarm {
  engine::FrameScene scene;
  engine::Frame frame;

  explicit Swarm(std::size_t robots) {
    scene.types = {{{{Solid{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 0.2}}, std::nullopt}}, true, 0.1415},
                   {{{Solid{{rectangle(-2, -0.05, 2, 0.05)}, {0, 0.5}}, std::nullopt}}, false, 2.01}};
    scene.bounds = {{-70, -30}, {70, 30}};
    Random random(1, 2, 3, 4);
    const auto pose = [&] {
      return Pose{random.uniform(-68, 68), random.uniform(-28, 28), 0, random.uniform(-k_pi, k_pi)};
    };
    for (int i = 0; i < 200; ++i) scene.fixed.push_back({1, pose(), {0.3F, 0.3F, 0.3F, 1}});
    for (std::size_t i = 0; i < robots; ++i) frame.mobile.push_back({0, pose(), {0.1F, 0.3F, 0.8F, 1}});
  }
};

void picture(benchmark::State& state, bool perspective) {
  const Swarm swarm(static_cast<std::size_t>(state.range(0)));
  render::Painter painter(swarm.scene);
  render::View view;
  view.camera.perspective = perspective;
  view.camera.pitch = perspective ? 0.87 : 0;
  benchmark::DoNotOptimize(painter.draw(swarm.frame, view));
  for (auto _ : state) benchmark::DoNotOptimize(painter.draw(swarm.frame, view));
}

void map(benchmark::State& state) { picture(state, false); }
void solids(benchmark::State& state) { picture(state, true); }

/// Frames of a film of 100 foot-bots in an arena of 6 x 6 m, with 1280 x 720 pixels: each robot moves from
/// frame to frame.
void film(benchmark::State& state, bool perspective) {
  engine::FrameScene scene;
  scene.types = {
      {{{Solid{{circle(0.085)}, {0, 0.15}}, std::nullopt}}, true, 0.085, "footbot"},
      {{{Solid{{rectangle(-3.05, -0.05, 3.05, 0.05)}, {0, 0.3}}, std::nullopt}}, false, 3.06, "wall"}};
  scene.bounds = {{-3.1, -3.1}, {3.1, 3.1}};
  for (const Pose& pose :
       {Pose{0, 3, 0, 0}, Pose{0, -3, 0, 0}, Pose{3, 0, 0, k_pi / 2}, Pose{-3, 0, 0, k_pi / 2}})
    scene.fixed.push_back({1, pose, {0.5F, 0.5F, 0.5F, 1}});
  Random random(1, 2, 3, 4);
  engine::Frame frame;
  for (std::uint32_t i = 0; i < 100; ++i)
    frame.mobile.push_back(
        {0,
         {random.uniform(-2.8, 2.8), random.uniform(-2.8, 2.8), 0, random.uniform(-k_pi, k_pi)},
         {0, 0.45F, 0.7F, 1},
         false,
         i});
  render::Painter painter(scene);
  render::View view;
  view.camera.perspective = perspective;
  view.camera.pitch = perspective ? 0.87 : 0;
  benchmark::DoNotOptimize(painter.draw(frame, view));
  for (auto _ : state) {
    frame.time_s += 0.04;
    for (engine::FrameBody& body : frame.mobile) {
      body.pose_world_body.x += 0.004 * std::cos(body.pose_world_body.heading);
      body.pose_world_body.y += 0.004 * std::sin(body.pose_world_body.heading);
      body.pose_world_body.heading += 0.01;
    }
    benchmark::DoNotOptimize(painter.draw(frame, view));
  }
}

void film_map(benchmark::State& state) { film(state, false); }
void film_perspective(benchmark::State& state) { film(state, true); }

BENCHMARK(film_map)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(film_perspective)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(map)->Arg(2000)->Arg(100000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(solids)
    ->Arg(2000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace troupe
