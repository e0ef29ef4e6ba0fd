// Measures the speed of the loops in which a tick spends most of its time:
//   build/release/bin/perf_kernels [--benchmark_filter=...]

#include "base/diagnostics.hpp"
#include "base/random.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "engine/world/world.hpp"
#include "partition/ranging.hpp"
#include "tests/support/paths.hpp"
#include "troupe/registry.hpp"
#include "worldio/load.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace troupe {
namespace {

/// Beams of 2 m in all directions, and 256 short edges scattered around their origin like walls and robots.
struct Scattered {
  explicit Scattered(std::size_t beams) {
    const std::size_t padded = partition::padded_beams(beams);
    const double step = 2 * k_pi / static_cast<double>(beams);
    for (std::size_t i = 0; i < padded; ++i) {
      const SinCos s = sincos(-k_pi + step * static_cast<double>(std::min(i, beams - 1)));
      dx.push_back(static_cast<float>(s.cos));
      dy.push_back(static_cast<float>(s.sin));
    }
    for (std::vector<float>* array : {&zero, &inverse, &limits}) array->resize(padded);
    range_max.resize(padded, 2.0f);
    fan = {dx.data(), dy.data(), zero.data(),    zero.data(),
           beams,     true,      beams % 2 == 0, beams > partition::k_most_beams ? &scan : nullptr};
    scan = {Vec2::UnitX(), static_cast<float>(2 * k_pi - step), static_cast<float>(step)};
    Random random(1, 2, 3, 4);
    circles.change_capacity(k_circles);
    std::vector<Vec2> ends;
    for (std::uint32_t i = 0; i < k_circles; ++i) {
      const Vec2 at(random.uniform(-2, 2), random.uniform(-2, 2));
      const Vec2 half(random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05));
      ends.insert(ends.end(), {at - half, at + half});
      circles.set(i, partition::enclosing_circle(at, half.norm(), i));
    }
    ends.resize(ends.size() + partition::EdgeBlock::k_piece);
    const std::size_t count = cull();
    for (std::size_t i = 0; i < count && edges.room() > 0; ++i)
      edges.add(ends[2 * met.row[i]], &ends[2 * met.row[i] + 1], 1, 1, met.beams[i]);
  }
  std::size_t cull() {
    const float farthest = partition::limits_of(fan, inverse.data(), range_max.data(), limits.data());
    return partition::may_meet(circles, 0, k_circles, Vec2::Zero(), fan, limits.data(),
                               -std::numeric_limits<float>::infinity(), farthest, met);
  }
  static constexpr std::size_t k_circles = 256;
  std::vector<float> dx, dy, zero, inverse, limits, range_max;
  partition::Scan scan;
  partition::Fan fan;
  partition::EdgeBlock edges;
  partition::CircleArrays circles;
  partition::MetCircles met;
};

void project_edges(benchmark::State& state) {
  Scattered s(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    std::ranges::fill(s.inverse, 0.0f);
    partition::project(s.edges, Vec2::Zero(), s.fan, s.inverse.data(), nullptr);
    benchmark::DoNotOptimize(s.inverse.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.edges.pieces().size()));
}
BENCHMARK(project_edges)->Arg(12)->Arg(16)->Arg(180)->Name("cast/project (items: edges)");

void cull_circles(benchmark::State& state) {
  Scattered s(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(s.cull());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(Scattered::k_circles));
}
BENCHMARK(cull_circles)->Arg(12)->Arg(16)->Arg(180)->Name("sweep/cull circles (items: circles)");

void polygon_overlap(benchmark::State& state) {
  const ConvexPrism box{{{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}, {0, 1}};
  const partition::ObstacleShape shape = partition::make_obstacle_shape({&box, 1});
  Random random(1, 2, 3, 4);
  std::vector<Pose> poses;
  for (int i = 0; i < 256; ++i)
    poses.push_back({random.uniform(-0.25, 0.25), random.uniform(-0.25, 0.25), 0, random.uniform(-3, 3)});
  for (auto _ : state)
    for (const Pose& pose : poses) benchmark::DoNotOptimize(partition::overlap(shape, Pose(), shape, pose));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(poses.size()));
}
BENCHMARK(polygon_overlap)->Name("overlap/box against box");

/// A dense crowd of robots on a square grid. Each robot moves with probability 1/2.
struct Crowd {
  explicit Crowd(std::size_t rows) {
    const ConvexPrism box{{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}}, {0, 0.1}};
    shape = partition::make_obstacle_shape({&box, 1});
    Random random(1, 2, 3, 4);
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(rows)));
    for (std::size_t r = 0; r < rows; ++r) {
      const Pose from{0.16 * static_cast<double>(r % side), 0.16 * static_cast<double>(r / side), 0,
                      random.uniform(-3, 3)};
      engine::Motion m;
      m.turn = random.uniform(-0.15, 0.15);
      m.moves = random.below(2) == 0;
      m.to = compose(from, {0.03, 0, 0, m.turn});
      m.rotation = Rotation(m.to.heading);
      poses.push_back(from);
      transforms.emplace_back(from);
      motions.push_back(m);
      shapes.push_back(&shape);
      ids.push_back(static_cast<std::uint32_t>(r));
      radii.push_back(shape.radius);
    }
  }
  partition::ObstacleShape shape;
  std::vector<engine::Motion> motions;
  std::vector<const partition::ObstacleShape*> shapes;
  std::vector<std::uint32_t> ids;
  std::vector<Pose> poses;
  std::vector<Transform> transforms;
  std::vector<double> radii;
};

void rebuild_index(benchmark::State& state) {
  const Crowd crowd(static_cast<std::size_t>(state.range(0)));
  partition::Parallel parallel(1);
  partition::BodyIndex index({0.5, 4});
  for (auto _ : state) index.rebuild(crowd.transforms, crowd.radii, parallel);
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(rebuild_index)->Arg(1000)->Arg(100000)->Name("index/rebuild (items: bodies)");

void resolve_conflicts(benchmark::State& state) {
  const Crowd crowd(static_cast<std::size_t>(state.range(0)));
  partition::Parallel parallel(1);
  partition::BodyIndex index({0.5, 4});
  index.rebuild(crowd.transforms, crowd.radii, parallel);
  const partition::StaticScene scene;
  engine::Conflicts conflicts;
  std::vector<engine::FreeCircle> free(crowd.motions.size());
  std::uint64_t tick = 0;
  for (auto _ : state) {
    conflicts.resolve({crowd.poses, crowd.transforms, crowd.motions, crowd.shapes, crowd.ids, free, 1, ++tick,
                       Box::around(Vec2::Zero(), 1e5)},
                      scene, index, parallel);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(resolve_conflicts)->Arg(1000)->Arg(100000)->Name("move/resolve a dense crowd (items: bodies)");

engine::WorldSpec load(const std::string& world, std::size_t robots, const engine::Registry& registry) {
  Diagnostics diagnostics;
  engine::WorldSpec spec = worldio::load_world(
      test::source_dir().string() + "/worlds/" + world, registry,
      {.seed = {}, .robots = {{"", robots}}, .set = {}, .search_path = {}, .threads = 1}, diagnostics);
  diagnostics.throw_if_errors();
  return spec;
}

/// Loads a population in a floor plan that is large enough for a million robots.
void load_population(benchmark::State& state) {
  const engine::Registry registry = make_registry();
  worldio::LoadOptions options;
  options.threads = static_cast<unsigned>(state.range(1));
  options.robots = {{"", static_cast<std::size_t>(state.range(0))}};
  options.set = {{"/floorplans/0/size_m", "[560, 240, 0.5]"},
                 {"/populations/0/place/region_m", "[[-278, -118], [278, 118]]"}};
  for (auto _ : state) {
    Diagnostics diagnostics;
    benchmark::DoNotOptimize(worldio::load_world(test::source_dir() / "worlds/hospital-10cm.json", registry,
                                                 options, diagnostics));
    diagnostics.throw_if_errors();
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(load_population)
    ->ArgNames({"robots", "threads"})
    ->ArgsProduct({{10000, 1000000}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond)
    ->Name("load/population (items: robots)");

/// Loads Stage's syntax with one entry per robot, as in Stage's hospital.world.
void load_text(benchmark::State& state) {
  const std::int64_t robots = state.range(0);
  std::string text =
      "define ir sensor( range [0 2] fov 30 samples 1 )\n"
      "define swarmbot position( size [0.1 0.1 0.1] color \"random\" ctrl \"expand_swarm\" ranger( pose [0 0 "
      "-0.05 0]";
  for (int k = 0; k < 12; ++k) text += fmt::format(" ir( pose [0 0 0 {}] )", 30 * k);
  text += " ) )\n";
  const auto side = static_cast<std::int64_t>(std::sqrt(static_cast<double>(robots)));
  for (std::int64_t r = 0; r < robots; ++r)
    text += fmt::format("swarmbot( name \"r{}\" pose [ {:.3f} {:.3f} 0 0 ] )\n", r,
                        0.25 * static_cast<double>(r / side), 0.25 * static_cast<double>(r % side));
  const engine::Registry registry = make_registry();
  for (auto _ : state) {
    Diagnostics diagnostics;
    benchmark::DoNotOptimize(worldio::load_stage_world("crowd.world", text, registry, {}, diagnostics));
    diagnostics.throw_if_errors();
  }
  state.SetItemsProcessed(state.iterations() * robots);
}
BENCHMARK(load_text)
    ->Arg(1000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->Name("load/.world text (items: robots)");

/// Builds a world from its parsed description.
void build_world(benchmark::State& state) {
  const engine::Registry registry = make_registry();
  const engine::WorldSpec spec =
      load("hospital-10cm.json", static_cast<std::size_t>(state.range(0)), registry);
  for (auto _ : state) {
    Diagnostics diagnostics;
    const engine::World world(spec, registry, {.threads = static_cast<unsigned>(state.range(1))},
                              diagnostics);
    benchmark::DoNotOptimize(&world);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(build_world)
    ->ArgNames({"robots", "threads"})
    ->ArgsProduct({{1, 100000}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond)
    ->Name("load/world from its spec (items: robots)");

/// Measures the sense phase. In each iteration, all sensors of every robot sense once, in the state after ten
/// ticks. This includes the search for walls and bodies within range, the tests that discard some of them,
/// and the intersection of the beams with the rest.
void sweep(benchmark::State& state, const char* world_file, std::size_t robots) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  engine::World world(load(world_file, robots, registry), registry, {.threads = 1}, diagnostics);
  for (int i = 0; i < 10; ++i) world.step();
  std::vector<Row> rows;
  for (const std::uint32_t row : world.view().index().order()) rows.emplace_back(row);
  std::vector<std::pair<const engine::BodyType::Device*, engine::StateTable>> sensors;
  for (const auto& sensor : world.view().type(rows.front()).devices)
    sensors.emplace_back(&sensor, world.tables()[sensor.table]);
  std::uint64_t beams = 0;
  engine::Effects none;
  engine::WorldState nothing;
  engine::Links unmoved(nothing, world.parallel());
  for (auto _ : state)
    for (auto& [sensor, table] : sensors) {
      const engine::DeviceBatch batch{.view = world.view(),
                                      .data = sensor->prepared.data,
                                      .rows = rows,
                                      .state = table,
                                      .commands = nullptr,
                                      .effects = none,
                                      .links = unmoved};
      beams += sensor->kind->sense(engine::SenseBatch{batch, world.view()});
    }
  state.SetItemsProcessed(static_cast<std::int64_t>(beams));
}
BENCHMARK_CAPTURE(sweep, hospital, "hospital-10cm.json", 10000)
    ->Unit(benchmark::kMillisecond)
    ->Name("sense/minibots (items: beams)");
BENCHMARK_CAPTURE(sweep, cave, "cave-simple.json", 100)
    ->Unit(benchmark::kMillisecond)
    ->Name("sense/sonars (items: beams)");
BENCHMARK_CAPTURE(sweep, laser, "cave-simple-laser.json", 100)
    ->Unit(benchmark::kMillisecond)
    ->Name("sense/sonars and laser (items: beams)");

void hash_state(benchmark::State& state) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  engine::World world(load("hospital-10cm.json", 10000, registry), registry, {.threads = 1}, diagnostics);
  for (auto _ : state) benchmark::DoNotOptimize(world.hashes());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(world.view().rows()));
}
BENCHMARK(hash_state)->Name("hash/whole state (items: robots)");

void whole_tick(benchmark::State& state) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  engine::World world(load("hospital-10cm.json", static_cast<std::size_t>(state.range(0)), registry),
                      registry, {.threads = 1}, diagnostics);
  for (auto _ : state) world.step();
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(whole_tick)
    ->Arg(1000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond)
    ->Name("tick/hospital-10cm (items: robots)");

}  // namespace
}  // namespace troupe
