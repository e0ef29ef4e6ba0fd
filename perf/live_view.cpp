// The cost of a picture of a running world for viewers (docs/live.md): `take` copies and rounds the poses on
// the thread of the simulation, `encode` computes the differences for one viewer on the thread of the server.

#include "live/picture.hpp"
#include "tests/support/paths.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/replay_header.hpp"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t k_most_robots = 100000;

/// A hospital with space for 100,000 robots, with a given number of robots, and the order in which pages list
/// these robots.
struct Shown {
  Simulation simulation;
  worldio::LivePage page;
};

Shown hospital(std::size_t robots) {
  Simulation simulation(test::source_dir() / "worlds/hospital-10cm.json",
                        {.threads = 1, .robots = {{"", robots}}});
  worldio::LivePage page = worldio::live_page(simulation.world(), simulation.registry());
  return {std::move(simulation), std::move(page)};
}

void take_picture(benchmark::State& state) {
  Shown shown = hospital(static_cast<std::size_t>(state.range(0)));
  shown.simulation.step();
  live::Picture picture;
  for (auto _ : state) live::take(shown.simulation.world(), shown.page.order, false, {}, picture);
}

/// Encodes pictures of consecutive ticks, in which nearly all robots have moved.
void encode_picture(benchmark::State& state) {
  const auto robots = static_cast<std::size_t>(state.range(0));
  Shown shown = hospital(robots);
  live::Picture picture;
  live::SentPicture sent;
  std::size_t bytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    shown.simulation.step();
    live::take(shown.simulation.world(), shown.page.order, false, {}, picture);
    state.ResumeTiming();
    bytes = live::encode(picture, shown.page.order.size(), 1, sent).size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}

BENCHMARK(take_picture)->Arg(2000)->Arg(k_most_robots)->Unit(benchmark::kMillisecond);
BENCHMARK(encode_picture)->Arg(2000)->Arg(k_most_robots)->Unit(benchmark::kMillisecond)->Iterations(20);

}  // namespace
}  // namespace troupe
