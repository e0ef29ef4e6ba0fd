// Simulation::reset() gives the state after loading, bit for bit, and then the same run.

#include "engine/observing/displacement.hpp"
#include "engine/observing/events.hpp"
#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace troupe::reset_test {
namespace {

namespace fs = std::filesystem;

constexpr int k_ticks = test::k_slow_build ? 4 : 25;

class ResetOf : public ::testing::TestWithParam<scenes::Run> {};
INSTANTIATE_TEST_SUITE_P(World, ResetOf, ::testing::ValuesIn(scenes::runs_of("reset")),
                         [](const auto& run) { return run.param.name(); });

/// Every byte of every table, and what is derived from them.
std::string bytes_of(const engine::World& world) {
  std::string all;
  const auto add = [&all](const auto& values) {
    all.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  for (const engine::StateTable& table : world.tables())
    for (std::size_t field = 0; field < table.fields().size(); ++field)
      for (std::size_t row = 0; row < table.rows(); ++row) {
        const std::size_t bytes =
            engine::element_size(table.fields()[field].element) * table.fields()[field].columns;
        all.append(reinterpret_cast<const char*>(table.cell<std::uint8_t>(row, field).data()), bytes);
      }
  for (std::size_t row = 0; row < world.view().rows(); ++row) {
    const Transform& transform = world.view().transform(Row(row));
    add(std::array{transform.position.x(), transform.position.y(), transform.rotation.cos,
                   transform.rotation.sin});
    for (const Vec2& vertex : world.view().outline(Row(row))) add(std::array{vertex.x(), vertex.y()});
  }
  return all;
}

TEST_P(ResetOf, IsTheStateAfterLoadingByteForByte) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  engine::WorldSpec spec = worldio::load_world(GetParam().file(), registry, {}, diagnostics);
  if (GetParam().by_grid) spec.ranging = RangingEngine::grid;
  engine::World world(std::move(spec), registry, {.threads = GetParam().threads, .tile_size_m = 0},
                      diagnostics);
  const std::string loaded = bytes_of(world);
  for (int tick = 0; tick < k_ticks; ++tick) world.step();
  const std::string later = bytes_of(world);
  ASSERT_NE(later, loaded);

  world.reset();
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_TRUE(bytes_of(world) == loaded);
  EXPECT_EQ(world.view().index().order().size(), world.view().rows());
  for (int tick = 0; tick < k_ticks; ++tick) world.step();
  EXPECT_TRUE(bytes_of(world) == later);
}

TEST_P(ResetOf, IsFollowedByTheSameRun) {
  SimulationOptions options;
  if (GetParam().by_grid) options.ranging = RangingEngine::grid;
  options.threads = GetParam().threads;
  Simulation simulation(GetParam().file(), options);
  const auto run = [&](int ticks) {
    std::string log = simulation.hash_log_line() + "\n";
    for (int tick = 0; tick < ticks; ++tick) {
      simulation.step();
      log += simulation.hash_log_line() + "\n";
    }
    return log;
  };
  const std::string first = run(k_ticks);
  const Statistics after = simulation.statistics();
  simulation.reset();
  run(3);  // a reset need not come at the end of a whole run
  simulation.reset();
  EXPECT_EQ(run(k_ticks), first);
  const Statistics again = simulation.statistics();
  EXPECT_EQ(again.ticks, after.ticks);
  EXPECT_EQ(again.time_s, after.time_s);
  EXPECT_EQ(again.beams, after.beams);
  EXPECT_EQ(again.stalled, after.stalled);
  EXPECT_EQ(again.held_at_bounds, after.held_at_bounds);
  EXPECT_EQ(again.mean_displacement_m, after.mean_displacement_m);
}

constexpr std::string_view k_room = R"({
  "troupe": 1,
  "types": {
    "wall": {"size_m": [0.2, 4, 1]},
    "bot": {"size_m": [0.4, 0.3, 0.25], "drive": {"kind": "diff"}, "sensors": [
      {"name": "eye", "kind": "ranger", "active": false, "pose": {"z_m": 0.1},
       "transducers": [{"range_max_m": 5}]}]}
  },
  "models": [
    {"name": "wall", "type": "wall", "pose": {"x_m": 2}},
    {"name": "r0", "type": "bot", "pose": {"heading_deg": 0}}
  ]
})";

class Reset : public test::ScratchTest {};

TEST_F(Reset, ForgetsCountersSpeedsAndReadings) {
  Simulation simulation(write("room.json", k_room));
  simulation.subscribe("r0");
  Model robot = simulation.find("r0");
  robot.set_speed(5, 0);
  simulation.run_for(3);
  ASSERT_TRUE(robot.stalled());
  ASSERT_GT(simulation.statistics().beams, 0u);

  simulation.reset();
  const Statistics statistics = simulation.statistics();
  EXPECT_EQ(simulation.time_s(), 0);
  EXPECT_EQ(statistics.ticks, 0u);
  EXPECT_EQ(statistics.beams, 0u);
  EXPECT_EQ(statistics.stalled, 0u);
  EXPECT_EQ(statistics.conflict_rounds, 0u);
  EXPECT_EQ(statistics.mean_displacement_m, 0);
  EXPECT_FALSE(robot.stalled());
  EXPECT_EQ(robot.pose().x, 0);
  EXPECT_EQ(robot.speed().forward, 0);
  EXPECT_EQ(robot.ranges()[0], 0);
  simulation.run_for(1);
  EXPECT_EQ(robot.pose().x, 0) << "the speed that was set before the reset still acts";
}

TEST_F(Reset, KeepsWhatTheProgramSet) {
  Simulation simulation(write("room.json", k_room));
  simulation.subscribe("r0");
  int phases = 0;
  simulation.on_phase([&phases](std::optional<Phase>) { ++phases; });
  simulation.step();
  simulation.reset();
  EXPECT_EQ(phases, 7) << "a reset is no phase";
  simulation.step();
  EXPECT_EQ(phases, 14);
  EXPECT_FLOAT_EQ(simulation.find("r0").ranges()[0], 1.9f);
}

TEST_F(Reset, TakesSubscriptionsAgain) {
  Simulation simulation(write("room.json", k_room));
  simulation.step();
  EXPECT_THROW(simulation.subscribe("r0"), std::logic_error);
  simulation.reset();
  simulation.subscribe("r0");
  simulation.step();
  EXPECT_FLOAT_EQ(simulation.find("r0").ranges()[0], 1.9f);
}

TEST_F(Reset, MakesAWorldOfUseAgainWhoseStepThrew) {
  Simulation simulation(write("room.json", k_room));
  const std::uint64_t loaded = simulation.state_hash();
  engine::World& world = simulation.world();
  world.set_command(world.view().row(simulation.find("r0").id()),
                    {std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_THROW(simulation.step(), std::runtime_error);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), loaded);
  EXPECT_NO_THROW(simulation.step());
}

/// A step that threw leaves rows of two ticks: nothing may be read as if it were a state, nor go on from it.
TEST_F(Reset, IsAllThatLeadsOnFromAStepThatThrew) {
  std::string text(k_room);
  text.replace(text.find("\"models\""), 0,
               R"("populations": [{"name": "s", "type": "bot", "count": 2, "reserve": 1,
    "place": {"rule": "grid", "region_m": [[-9, -9], [-5, -5]], "pitch_m": 1}}],
  )");
  Simulation simulation(write("room.json", text));
  simulation.subscribe("r0");
  Model robot = simulation.find("r0");
  Swarm swarm = simulation.swarm();
  Measures measures(simulation, {"stalls"});
  engine::EventWatch events(simulation.world());
  std::vector<Pose> poses(swarm.size());
  std::vector<float> ranges(swarm.size());
  const std::vector<Model::Speed> speeds(swarm.size());
  engine::World& world = simulation.world();
  const Row row = world.view().row(robot.id());
  const fs::path checkpoint = folder_ / "c.h5";
  const fs::path recording = folder_ / "r.h5";
  const std::vector<std::pair<const char*, std::function<void()>>> uses{
      {"step", [&] { simulation.step(); }},
      {"run_for", [&] { simulation.run_for(1); }},
      {"run_until", [&] { simulation.run_until([](const Simulation&) { return true; }, 1); }},
      {"save", [&] { simulation.save(checkpoint); }},
      {"record", [&] { simulation.record(recording); }},
      {"state_hash", [&] { simulation.state_hash(); }},
      {"hashes", [&] { simulation.hashes(); }},
      {"hash_log_line", [&] { simulation.hash_log_line(); }},
      {"statistics", [&] { simulation.statistics(); }},
      {"energy", [&] { simulation.energy(); }},
      {"robot_names", [&] { simulation.robot_names(); }},
      {"cast", [&] { simulation.cast({}, 1); }},
      {"set_poses",
       [&] {
         simulation.set_poses(std::array{std::pair(robot, Pose{1, 1, 0, 0})});
       }},
      {"spawn",
       [&] {
         simulation.spawn("s", {3, 3, 0, 0});
       }},
      {"unborn", [&] { simulation.unborn("s"); }},
      {"remove", [&] { simulation.remove(robot); }},
      {"pose", [&] { robot.pose(); }},
      {"set_speed", [&] { robot.set_speed(1, 0); }},
      {"accelerate", [&] { robot.accelerate(1, 0); }},
      {"go_to", [&] { robot.go_to(1, 0, 0); }},
      {"speed", [&] { robot.speed(); }},
      {"is_alive", [&] { robot.is_alive(); }},
      {"stalled", [&] { robot.stalled(); }},
      {"estimate", [&] { robot.estimate(); }},
      {"set_pose", [&] { robot.set_pose({}); }},
      {"is_free", [&] { robot.is_free({}); }},
      {"ranges", [&] { robot.ranges(); }},
      {"readings", [&] { robot.readings<float>("ranges"); }},
      {"swarm.poses", [&] { swarm.poses(poses); }},
      {"swarm.ranges", [&] { swarm.ranges(ranges); }},
      {"swarm.set_speeds", [&] { swarm.set_speeds(speeds); }},
      {"swarm.set_poses", [&] { swarm.set_poses(poses); }},
      {"swarm.for_each", [&] { swarm.for_each([](std::size_t, Model&) {}); }},
      {"measures.see", [&] { measures.see(); }},
      {"measures.values", [&] { measures.values(); }},
      {"measures.value", [&] { measures.value("stalls"); }},
      {"new measures", [&] { Measures(simulation, {"stalls"}); }},
      {"events.see", [&] { events.see(world); }},
      {"world.step", [&] { world.step(); }},
      {"world.tables", [&] { world.tables(); }},
      {"world.frame", [&] { engine::make_frame(world); }},
      {"world.hashes", [&] { world.hashes(); }},
      {"world.set_command", [&] { world.set_command(row, {}); }},
      {"world.mean_displacement", [&] { engine::mean_displacement(world); }},
  };
  const std::uint64_t loaded = simulation.state_hash();
  world.set_command(row, {std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_THROW(simulation.step(), engine::StepError);
  for (const auto& [name, use] : uses) {
    try {
      use();
      ADD_FAILURE() << name << " goes on";
    } catch (const std::logic_error& error) {
      EXPECT_STREQ(error.what(),
                   "tick 1: a step, a birth or a reset failed and left an incomplete state: call reset() "
                   "before anything else")
          << name;
    }
  }
  EXPECT_FALSE(fs::exists(checkpoint));
  EXPECT_FALSE(fs::exists(recording));
  EXPECT_EQ(simulation.tick(), 1u) << "clocks can be read";
  EXPECT_EQ(robot.name(), "r0");

  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), loaded);
  EXPECT_NO_THROW(simulation.run_for(1));
  swarm.poses(poses);
  measures.see();
}

TEST_F(Reset, LeadsOnFromACallbackThatThrewInAStep) {
  Simulation simulation(write("room.json", k_room));
  const std::uint64_t loaded = simulation.state_hash();
  simulation.on_phase([](std::optional<Phase> phase) {
    if (phase == Phase::move) throw std::runtime_error("enough");
  });
  EXPECT_THROW(simulation.step(), std::runtime_error);
  EXPECT_THROW(simulation.state_hash(), std::logic_error);
  simulation.on_phase(nullptr);
  EXPECT_THROW(simulation.step(), std::logic_error);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), loaded);
  simulation.on_tick([](Simulation&) { throw std::runtime_error("enough"); });
  EXPECT_THROW(simulation.step(), std::runtime_error);
  EXPECT_NO_THROW(simulation.state_hash()) << "the tick is complete";
}

// Ground sensors keep the contours and colours of static zones. A reset with another seed gives the zones
// other places and colours.
TEST_F(Reset, WithASeedShowsGroundSensorsTheZonesOfThisSeed) {
  for (const std::string place : {R"({"rule": "uniform", "region_m": [[-2, -2], [2, 2]]})",
                                  R"({"rule": "grid", "region_m": [[-2, -2], [2, 2]], "pitch_m": 0.8})"}) {
    const auto file = write("zones.json", R"({"troupe": 1, "types": {
      "zone": {"size_m": [0.5, 0.5, 0.002], "obstacle": false, "ranger_return": -1},
      "bot": {"size_m": [0.05, 0.05, 0.2], "drive": {"kind": "diff"},
              "sensors": [{"name": "eye", "kind": "ground"}]}},
     "populations": [{"name": "z", "type": "zone", "color": "random", "count": 20, "place": )" +
                                              place +
                                              R"(},
      {"name": "r", "type": "bot", "count": 30,
       "place": {"rule": "grid", "region_m": [[-1.9, -1.9], [1.9, 1.9]], "pitch_m": 0.6}}],
     "at": [{"time_s": 0.3, "set": {"type": "bot", "device": {"name": "eye", "floor": [0.5, 0.5, 0.5]}}}]})");
    const auto run = [](Simulation& simulation) {
      for (int robot = 0; robot < 30; ++robot) simulation.subscribe("r" + std::to_string(robot));
      std::string log;
      for (int tick = 0; tick < 6; ++tick) {
        simulation.step();
        log += simulation.hash_log_line() + "\n";
      }
      return log;
    };
    Simulation fresh(file, {.threads = 1, .seed = 2});
    const std::string expected = run(fresh);
    Simulation again(file, {.threads = 1, .seed = 1});
    EXPECT_NE(run(again), expected);
    again.reset(2);
    EXPECT_EQ(run(again), expected) << place;
  }
}

}  // namespace
}  // namespace troupe::reset_test
