#include "perf/paper_cases.hpp"

#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace troupe::perf {
namespace {

namespace fs = std::filesystem;

constexpr double k_memory_s = 1;
constexpr double k_cluster_skip_s = 60;

/// Simulated time of the rows of each table, s, unless worlds/scenes.json sets another.
const std::map<std::string, double, std::less<>> k_times_s = {
    // The paper's tables.
    {"1", 600},
    {"2", 600},
    {"3", 60},
    // Kernels without vector instructions take about ten times as long as the best ones.
    {"simd", 60},
    // Clusters are measured after k_cluster_skip_s, when they are dense, in pieces of 2 s.
    {"clusters", 2},
    // 60 s of a million robots would take minutes in each repetition. 5 s are enough to measure the speed.
    {"campus", 5},
    {"watching", 60},
    {"grid", 60},
    {"devices", 60},
    {"memory", k_memory_s},
};
// With --quick, times are multiplied by this factor. Clusters and campus have their own times instead.
constexpr double k_quick = 0.01;
constexpr double k_quick_cluster_skip_s = 1;
constexpr double k_quick_cluster_s = 0.2;
constexpr double k_quick_campus_s = 0.2;

/// The scene of an entry of worlds/scenes.json, with this number of robots in total. for_s: simulated time,
/// s.
Scene scene_of(const scenes::Benchmark& row, std::size_t robots, double for_s) {
  Scene scene{.name = fmt::format("{}/{}", fs::path(row.world).stem().string(), robots),
              .world = test::source_dir() / "worlds" / row.world,
              .robots = robots,
              .for_s = for_s};
  if (row.populations.empty()) scene.load.robots = {{"", robots}};
  for (const std::string& name : row.populations)
    scene.load.robots.emplace_back(name, robots / row.populations.size());
  return scene;
}

Scene variant_of(Scene scene, const scenes::Variant& variant) {
  scene.name = fmt::format("{}/{}", variant.name, scene.robots);
  scene.load.set.insert(scene.load.set.end(), variant.set.begin(), variant.set.end());
  return scene;
}

/// Returns two scenes with these times: the given one, in which robots disperse, and a variant in which they
/// form clusters.
std::vector<Scene> dispersed_and_clustered(Scene scene, double skip_s, double for_s) {
  scene.skip_s = skip_s;
  scene.for_s = for_s;
  Scene clustered = scene;
  scene.name = "dispersed-" + scene.name;
  clustered.name = "clustered-" + clustered.name;
  clustered.load.set.emplace_back("/types/minibot/controller/invert", "true");
  return {scene, clustered};
}

/// The tables of the report, in their order.
std::vector<Table> make_tables() {
  return {
      {"1", "Table 1: Pioneers in the cave",
       "Each robot has 16 sonars of 5 m; with `laser`, also a scanner of 180 beams of 8 m. A simple body is "
       "one octagon; a complex body consists of seven prisms, and the laser of four more."},
      {"2", "Table 2: minibots of 0.2 m in the hospital", "Each robot has 12 infrared beams of 2 m."},
      {"3", "Table 3: minibots of 0.1 m in the hospital",
       "In this table, the world `stage` is Stage's own `hospital.world` with its 1,000 robots."},
      {"simd", "Comparison of instruction sets",
       "Wall time in ns per robot and tick, on one thread. The runs of a row take turns, and all end with "
       "the same hash. docs/determinism.md describes how to select an instruction set."},
      {"clusters", "Clusters",
       "Robots of `dispersed` keep away from one another; those of `clustered`, with the parameter `invert`, "
       "gather. Both are measured when the robots have dispersed or gathered; the repetitions are "
       "consecutive pieces of one run."},
      {"campus", "A million minibots in sixteen hospitals", ""},
      {"watching", "Cost of observers",
       "In every tick of 0.1 s an observer computes hashes (as for --hash-log), records poses (as for "
       "--record), or computes all measures of docs/measures.md. The cost is the additional time relative to "
       "the same run without observer, the median over the repetitions."},
      {"grid", "The paper's ray tracer and the exact engine", ""},
      {"devices", "Robots with other devices",
       "Devices of each robot: `foragers` have a scanner of 19 beams, a fiducial finder, a gripper and a "
       "power pack, and carry pucks to places that accept them (mills). `harvesters` have 9 beams, a finder "
       "and a gripper, and carry "
       "pucks home. `pushers` have 9 beams and push 20,000 pucks. `finders` have 9 beams and a finder with "
       "about 16 robots in its range; `finders-off` is the same without finders. The rays of finders count "
       "as beams. `radios` have a ring of 12 infrared rangers and a radio with 20 robots in its range; "
       "`radios-off` has only the rangers, `rangers-off` only the radios."},
  };
}

}  // namespace

fs::path stage_worlds() { return test::source_dir() / "../shared/stage-worlds"; }

Result<> has_world(const Scene& scene) {
  if (std::error_code ignored; !fs::exists(scene.world, ignored))
    return Error{fmt::format("the world file {} does not exist", scene.world.lexically_normal().string())};
  return {};
}

Plan make_plan(bool quick, const std::vector<unsigned>& threads, const std::vector<std::string>& simd) {
  Plan plan;
  plan.tables = make_tables();
  const scenes::Manifest manifest = scenes::read_manifest(test::source_dir() / "worlds/scenes.json");
  const auto with_threads = [&](const Scene& scene) {
    std::vector<Run> runs;
    for (const unsigned n : threads) runs.push_back({scene, n, false});
    return runs;
  };
  // The manifest, worlds/scenes.json, gives worlds and numbers of robots. The code below determines how the
  // rows of a table are run.
  const auto for_rows = [&](std::string_view table, const auto& add) {
    for (const scenes::Benchmark& row : manifest.perf) {
      if (row.table != table) continue;
      const double for_s = (quick ? k_quick : 1) * row.for_s.value_or(k_times_s.find(table)->second);
      for (const std::size_t robots : quick ? row.quick : row.robots) add(scene_of(row, robots, for_s), row);
    }
  };
  for (const scenes::Benchmark& row : manifest.perf)
    if (!k_times_s.contains(row.table))
      throw std::runtime_error(fmt::format(
          "worlds/scenes.json: error: \"perf\": the entry of {} has the unknown table \"{}\"; known: "
          "1, 2, 3, campus, clusters, devices, grid, memory, simd, watching",
          row.world, row.table));

  // As in the paper, each scene is run without and with pictures.
  for (const char* table : {"1", "2", "3"})
    for_rows(table, [&](const Scene& scene, const auto&) {
      std::vector<Run> runs = with_threads(scene);
      runs.push_back({scene, threads.front(), true});
      plan.cases.push_back({table, std::move(runs)});
    });
  const Scene stage{.name = "stage/1000",
                    .world = stage_worlds() / "benchmark/hospital.world",
                    .robots = 1000,
                    .for_s = (quick ? k_quick : 1) * k_times_s.find("3")->second};
  plan.cases.push_back({"3", with_threads(stage)});
  plan.cases.back().runs.push_back({stage, threads.front(), true});

  for_rows("simd", [&](const Scene& scene, const auto&) {
    Case sets{"simd", {}};
    for (const std::string& name : simd) sets.runs.push_back({.scene = scene, .threads = 1, .simd = name});
    plan.cases.push_back(std::move(sets));
  });

  for_rows("clusters", [&](const Scene& scene, const scenes::Benchmark&) {
    const std::vector<Scene> pair = dispersed_and_clustered(
        scene, quick ? k_quick_cluster_skip_s : k_cluster_skip_s, quick ? k_quick_cluster_s : scene.for_s);
    Case both{"clusters", {}};
    for (const Scene& one : pair) std::ranges::move(with_threads(one), std::back_inserter(both.runs));
    plan.cases.push_back(std::move(both));
  });

  for_rows("campus", [&](Scene scene, const auto&) {
    if (quick) scene.for_s = k_quick_campus_s;
    plan.cases.push_back({"campus", with_threads(scene)});
  });

  for_rows("watching", [&](const Scene& scene, const auto&) {
    Case watching{"watching", {}};
    for (const unsigned n : threads)
      for (const Watch watch : {Watch::nothing, Watch::hashes, Watch::recording, Watch::measures})
        watching.runs.push_back({scene, n, false, watch});
    plan.cases.push_back(std::move(watching));
  });

  for_rows("grid", [&](const Scene& exact, const auto&) {
    Scene grid = exact;
    grid.name = "grid-" + grid.name;
    grid.grid = true;
    plan.cases.push_back({"grid", {{exact, threads.front(), false}, {grid, threads.front(), false}}});
  });

  // A world, and variants of it that lack a sensor: the difference is the cost of that sensor.
  for_rows("devices", [&](const Scene& scene, const scenes::Benchmark& row) {
    std::vector<Run> runs =
        row.beside.empty() ? with_threads(scene) : std::vector<Run>{{scene, threads.front()}};
    for (const scenes::Variant& variant : row.beside)
      runs.push_back({variant_of(scene, variant), threads.front()});
    plan.cases.push_back({"devices", std::move(runs)});
  });

  for_rows("memory", [&](Scene scene, const scenes::Benchmark& row) {
    scene.for_s = row.for_s.value_or(k_memory_s);
    if (row.as_text) plan.children.push_back({scene_of(row, 0, k_memory_s), false, true});
    plan.children.push_back({scene, false, false});
    if (row.as_text) plan.children.push_back({scene, true, false});
  });
  return plan;
}

}  // namespace troupe::perf
