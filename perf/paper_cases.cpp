#include "perf/paper_cases.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::perf {
namespace {

namespace fs = std::filesystem;

// Times of the paper's tables, s.
constexpr double k_tables_1_2_s = 600;
constexpr double k_table_3_s = 60;
// A million robots for 60 s are 600 million robot ticks: minutes for each repetition. 5 s show the rate.
constexpr double k_campus_s = 5;
constexpr double k_radios_s = 10;
// Portable kernels take some ten times as long as the best ones.
constexpr double k_simd_s = 60;
// Clusters are timed after a minute, when they are tight, in pieces of 2 s.
constexpr double k_cluster_skip_s = 60;
constexpr double k_cluster_s = 2;
constexpr std::size_t k_campus_houses = 16;

template <class Spec>
bool switch_to_grid(Spec& spec) {
  using Engine = decltype(spec.ranging);
  if constexpr (requires { Engine::grid; }) {
    spec.ranging = Engine::grid;
    return true;
  } else {
    return false;
  }
}

fs::path shipped(const char* world) { return fs::path(TROUPE_SOURCE_DIR) / "worlds" / world; }

Scene population(const std::string& world, std::size_t robots, double for_s) {
  Scene scene{.name = fmt::format("{}/{}", world, robots),
              .world = shipped(fmt::format("{}.json", world).c_str()),
              .robots = robots,
              .for_s = for_s};
  scene.load.robots = {{"", robots}};
  return scene;
}

/// Of a world with several populations, of which one is the robots.
Scene robots_of(const std::string& world, std::size_t robots, double for_s) {
  Scene scene = population(world, robots, for_s);
  scene.load.robots = {{"r", robots}};
  return scene;
}

Scene campus(std::size_t robots, double for_s) {
  Scene scene{.name = fmt::format("campus/{}", robots),
              .world = shipped("campus.json"),
              .robots = robots,
              .for_s = for_s};
  for (std::size_t house = 0; house < k_campus_houses; ++house)
    scene.load.robots.emplace_back(std::string(1, static_cast<char>('a' + house)), robots / k_campus_houses);
  return scene;
}

/// What the clusters are compared with, and the clusters.
std::vector<Scene> dispersed_and_clustered(Scene scene, double skip_s, double for_s) {
  scene.skip_s = skip_s;
  scene.for_s = for_s;
  Scene clustered = scene;
  scene.name = "dispersed-" + scene.name;
  clustered.name = "clustered-" + clustered.name;
  clustered.load.set.emplace_back("/types/minibot/controller/invert", "true");
  return {scene, clustered};
}

}  // namespace

fs::path stage_worlds() { return fs::path(TROUPE_SOURCE_DIR) / "../shared/stage-worlds"; }

bool use_grid(engine::WorldSpec& spec) { return switch_to_grid(spec); }

std::string missing(const Scene& scene) {
  engine::WorldSpec probe;
  if (scene.grid && !use_grid(probe)) return "this build has no grid engine";
  if (std::error_code ignored; !fs::exists(scene.world, ignored))
    return fmt::format("there is no {}", scene.world.lexically_normal().string());
  return {};
}

Plan make_plan(bool quick, const std::vector<unsigned>& threads, const std::vector<std::string>& simd) {
  Plan plan;
  plan.tables = {
      {"1", "Table 1: Pioneers in the cave",
       "16 sonars of 5 m each, with `laser` 180 beams of 8 m more; simple: one octagon a body, complex: "
       "seven "
       "prisms and four of the laser's."},
      {"2", "Table 2: minibots of 0.2 m in the hospital", "12 infrared beams of 2 m each."},
      {"3", "Table 3: minibots of 0.1 m in the hospital",
       "`stage` is Stage's own `hospital.world` with its 1,000 robots."},
      {"simd", "Instruction sets, one beside the other",
       "ns a robot and tick on one thread, each row's sets in turn; every one ends with the same hash. "
       "docs/determinism.md says how a run is given another than the processor's best."},
      {"clusters", "Clusters",
       "With `invert` robots gather. Both behaviours are timed after the time that dispersal takes, as "
       "consecutive pieces of one run."},
      {"campus", "A million minibots in sixteen hospitals", ""},
      {"watching", "What looking on costs",
       "At every tick of 0.1 s: hashes as --hash-log takes them; poses as --record writes them; all measures "
       "of "
       "docs/measures.md. Against the same run unwatched: the median over the repetitions."},
      {"grid", "The paper's ray tracer beside the exact engine", ""},
      {"devices", "Robots that do more than range",
       "`foragers`: a scanner of 19 beams, a fiducial finder, a gripper and a power pack each; they grip "
       "pucks "
       "and carry them to mills. `harvesters`: 9 beams, a finder and a gripper each; they carry pucks home. "
       "`pushers`: 9 beams each; they push 20,000 pucks about. `finders`: 9 beams "
       "and a finder each, with some 16 others in its range; "
       "`finders-off`: the same without their finders. Beams are those of finders, too. `radios`: a ring of "
       "12 "
       "infrared rangers and a radio each, with 20 others in its range; `radios-off` has the rangers alone, "
       "`rangers-off` the radios."},
  };
  const double times = quick ? 0.01 : 1;
  const auto with_threads = [&](const Scene& scene) {
    std::vector<Run> runs;
    for (const unsigned n : threads) runs.push_back({scene, n, false});
    return runs;
  };
  // As the paper has it: without pictures and with them.
  const auto add = [&](const char* table, const Scene& scene) {
    std::vector<Run> runs = with_threads(scene);
    runs.push_back({scene, threads.front(), true});
    plan.cases.push_back({table, std::move(runs)});
  };

  for (const char* world : {"cave-simple", "cave-complex", "cave-simple-laser", "cave-complex-laser"})
    for (const std::size_t robots : {1, 10, 50, 100})
      if (!quick || robots <= 10) add("1", population(world, robots, times * k_tables_1_2_s));
  for (const std::size_t robots : {1, 10, 50, 100, 200, 500, 1000, 2000})
    if (!quick || robots <= 50) add("2", population("hospital", robots, times * k_tables_1_2_s));
  for (const std::size_t robots : {1000, 2000, 10000, 100000})
    if (!quick || robots <= 1000) add("3", population("hospital-10cm", robots, times * k_table_3_s));
  add("3", {.name = "stage/1000",
            .world = stage_worlds() / "benchmark/hospital.world",
            .robots = 1000,
            .for_s = times * k_table_3_s});

  for (const Scene& scene : {population("hospital", quick ? 50 : 2000, times * k_simd_s),
                             population("hospital-10cm", quick ? 1000 : 10000, times * k_table_3_s),
                             population("cave-simple", quick ? 10 : 100, times * k_simd_s),
                             population("cave-complex", quick ? 10 : 100, times * k_simd_s),
                             population("cave-simple-laser", quick ? 10 : 100, times * k_simd_s),
                             population("cave-complex-laser", quick ? 10 : 100, times * k_simd_s)}) {
    Case sets{"simd", {}};
    for (const std::string& name : simd) sets.runs.push_back({.scene = scene, .threads = 1, .simd = name});
    plan.cases.push_back(std::move(sets));
  }

  for (const Scene& scene : {population("hospital", quick ? 200 : 2000, 0),
                             population("hospital-10cm", quick ? 500 : 100000, 0)}) {
    const std::vector<Scene> pair =
        dispersed_and_clustered(scene, quick ? 1 : k_cluster_skip_s, quick ? 0.2 : k_cluster_s);
    Case both{"clusters", {}};
    for (const Scene& one : pair) std::ranges::move(with_threads(one), std::back_inserter(both.runs));
    plan.cases.push_back(std::move(both));
  }

  plan.cases.push_back({"campus", with_threads(campus(quick ? 1600 : 1000000, quick ? 0.2 : k_campus_s))});

  const Scene watched = population("hospital-10cm", quick ? 1000 : 10000, times * k_table_3_s);
  Case watching{"watching", {}};
  for (const unsigned n : threads)
    for (const Watch watch : {Watch::nothing, Watch::hashes, Watch::recording, Watch::measures})
      watching.runs.push_back({watched, n, false, watch});
  plan.cases.push_back(std::move(watching));

  const Scene exact = population("hospital", quick ? 50 : 1000, quick ? 0.6 : k_table_3_s);
  Scene grid = exact;
  grid.name = "grid-" + grid.name;
  grid.grid = true;
  plan.cases.push_back({"grid", {{exact, threads.front(), false}, {grid, threads.front(), false}}});

  plan.cases.push_back(
      {"devices", with_threads(robots_of("foragers", quick ? 100 : 2000, times * k_table_3_s))});
  plan.cases.push_back(
      {"devices", with_threads(robots_of("harvesters", quick ? 100 : 10000, times * k_table_3_s))});
  plan.cases.push_back(
      {"devices", with_threads(robots_of("pushers", quick ? 100 : 10000, times * k_table_3_s))});
  const Scene finders = robots_of("finders", quick ? 100 : 1000, times * k_table_3_s);
  Scene without = finders;
  without.name = "finders-off/" + finders.name.substr(finders.name.find('/') + 1);
  without.load.set.emplace_back("/types/bot/sensors/1/active", "false");
  plan.cases.push_back({"devices", {{finders, threads.front()}, {without, threads.front()}}});

  // Radios beside rangers, rangers alone, radios alone: what each costs is the first less one of the others.
  const Scene radios = robots_of("radios", quick ? 200 : 10000, times * k_radios_s);
  const auto without_sensor = [&](const char* name, std::size_t sensor) {
    Scene scene = radios;
    scene.name = fmt::format("{}/{}", name, radios.robots);
    scene.load.set.emplace_back(fmt::format("/types/bot/sensors/{}/active", sensor), "false");
    return scene;
  };
  plan.cases.push_back({"devices",
                        {{radios, threads.front()},
                         {without_sensor("radios-off", 1), threads.front()},
                         {without_sensor("rangers-off", 0), threads.front()}}});

  const auto child = [&](Scene scene, bool as_text = false) {
    plan.children.push_back({std::move(scene), as_text, false});
  };
  plan.children.push_back({population("hospital-10cm", 0, 1), false, true});
  child(population("hospital-10cm", quick ? 1000 : 100000, 1));
  child(population("hospital-10cm", quick ? 1000 : 100000, 1), true);
  child(campus(quick ? 1600 : 1000000, 0.2));
  child(robots_of("radios", quick ? 1000 : 100000, 1));
  return plan;
}

}  // namespace troupe::perf
