// Measures the time to draw a picture of a large swarm, without the first picture, which takes longer:
//   build/release/bin/perf_pictures

#include "base/random.hpp"
#include "render/draw.hpp"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <utility>

namespace troupe {
namespace {

Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
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

BENCHMARK(map)->Arg(2000)->Arg(100000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(solids)
    ->Arg(2000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace troupe
