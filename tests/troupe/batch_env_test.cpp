#include "troupe/batch_env.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/world/world.hpp"
#include "models/devices/led.hpp"
#include "troupe/measures.hpp"
#include "troupe/registry.hpp"
#include "troupe/swarm.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::batch_env_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;
using Of = BatchPart::Of;

/// Robots that learn, and one that wanders; each of the former has a goal, and pillars stand anywhere.
constexpr std::string_view k_learning_room = R"({
  "troupe": 1, "seed": 3,
  "types": {
    "wall": {"size_m": [0.1, 7.8, 0.5]},
    "pillar": {"size_m": [0.3, 0.3, 0.5]},
    "goal": {"size_m": [0.2, 0.2, 0.01], "obstacle": false, "ranger_return": -1},
    "bot": {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff", "localization": "odom"},
            "sensors": [{"name": "lidar", "kind": "ranger", "pose": {"z_m": 0.1},
                         "transducers": [{"range_max_m": 3, "fov_deg": 330, "samples": 12, "noise_stddev_m": 0.01}]}],
            "devices": [{"name": "lamp", "kind": "led"}],
            "controller": {"kind": "wander"}}
  },
  "models": [
    {"name": "w", "type": "wall", "pose": {"x_m": -4}}, {"name": "e", "type": "wall", "pose": {"x_m": 4}},
    {"name": "s", "type": "wall", "pose": {"y_m": -4, "heading_deg": 90}},
    {"name": "n", "type": "wall", "pose": {"y_m": 4, "heading_deg": 90}}
  ],
  "populations": [
    {"name": "pillar", "type": "pillar", "count": 3, "place": {"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}},
    {"name": "r", "type": "bot", "count": 4, "color": "random", "place": {"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}},
    {"name": "other", "type": "bot", "count": 2, "place": {"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}},
    {"name": "goal", "type": "goal", "count": 4, "place": {"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}
  ]
})";

Simulation learning_room(std::uint64_t seed = 3, std::string text = std::string(k_learning_room)) {
  return Simulation::from_text(std::move(text), "room.json", {.threads = 1, .seed = seed});
}

BatchSpec spec_of(std::size_t copies, unsigned threads = 1) {
  BatchTeam team{.name = "bots", .robots = "r"};
  team.arrays = {{"see",
                  {{.of = Of::reading, .device = "lidar", .field = "ranges", .scale = 0.5},
                   {.of = Of::nearest, .name = "bot", .count = 2, .range_m = 4}}},
                 {"state", {{.of = Of::pose}, {.of = Of::estimate}, {.of = Of::speed}, {.of = Of::stalled}}},
                 {"goal", {{.of = Of::target, .name = "goal"}, {.of = Of::time_left}}},
                 {"raw", {{.of = Of::reading, .field = "shown_color"}}, true}};
  team.actions = {{.command = "forward", .low = 0, .high = 0.5},
                  {.command = "turn", .low = -1, .high = 1},
                  {.device = "lamp", .command = "red", .low = 0, .high = 1},
                  {.device = "lamp", .command = "shows", .low = 0, .high = 1}};
  team.rewards = {{.of = {.array = "goal", .column = 2}, .weight = -1, .change = true},
                  {.of = {.measure = "mean_nearest_distance"}, .weight = 0.25}};
  team.ends = {{.of = {.array = "goal", .column = 2}, .below = 0.5, .reward = 5}};
  return {.copies = copies,
          .threads = threads,
          .ticks = 2,
          .seconds = 4,
          .teams = {team},
          .measures = {"mean_nearest_distance"}};
}

/// From -1 to 1, of a copy's robot in a step.
double action_of(std::size_t step, std::size_t robot, std::size_t column) {
  return std::sin(static_cast<double>(7 * step + 3 * robot + column));
}

void act(BatchEnv& batch, std::size_t step) {
  const std::size_t columns = batch.spec().teams[0].actions.size();
  for (std::size_t k = 0; k < batch.actions(0).size(); ++k)
    batch.actions(0)[k] = action_of(step, k / columns % batch.robots(0), k % columns);
}

/// Everything that a batch gives in a step, byte for byte.
std::vector<std::byte> given(BatchEnv& batch) {
  std::vector<std::byte> all;
  const auto add = [&](auto values) {
    const auto bytes = std::as_bytes(values);
    all.insert(all.end(), bytes.begin(), bytes.end());
  };
  for (const char* name : {"see", "state", "goal", "raw"}) add(std::span(batch.array(0, name).bytes));
  add(batch.rewards(0));
  add(batch.terminated(0));
  add(batch.truncated());
  add(batch.measures());
  add(batch.seeds());
  return all;
}

TEST(AnotherSeed, IsTheWorldLoadedWithIt) {
  Simulation one = learning_room(3);
  one.swarm("r").set_speeds(std::vector<Model::Speed>(4, {0.3, 0, 0.1}));
  for (int i = 0; i < 30; ++i) one.step();
  for (const std::uint64_t seed : {11u, 12u, 3u}) {
    Simulation loaded = learning_room(seed);
    Simulation copy = one.another(seed, 1);
    one.reset(seed);
    for (int tick = 0; tick < 40; ++tick) {
      ASSERT_EQ(one.state_hash(), loaded.state_hash()) << "seed " << seed << ", tick " << tick;
      ASSERT_EQ(copy.state_hash(), loaded.state_hash()) << "seed " << seed << ", tick " << tick;
      for (Simulation* each : {&one, &copy, &loaded}) each->step();
    }
    EXPECT_EQ(one.seed(), seed);
    const BodyId pillar = loaded.find("pillar0").id();
    EXPECT_EQ(one.world().view().pose(pillar), loaded.world().view().pose(pillar));
    EXPECT_EQ(one.world().spec().bodies[one.find("r0").id().index()].color.r,
              loaded.world().spec().bodies[loaded.find("r0").id().index()].color.r);
  }
}

TEST(AnotherSeed, IsRefusedAsTheLoaderDoes) {
  std::string text(k_learning_room);
  const std::string wide = R"("rule": "uniform", "region_m": [[-3, -3], [3, 3]])";
  for (std::size_t at; (at = text.find(wide)) != text.npos;)
    text.replace(at, wide.size(), R"("rule": "uniform", "region_m": [[-0.54, -0.54], [0.54, 0.54]])");
  std::optional<Simulation> one;
  for (std::uint64_t seed = 1; !one && seed < 40; ++seed) try {
      one.emplace(learning_room(seed, text));
    } catch (const InputError&) {
    }
  ASSERT_TRUE(one);
  int refused = 0;
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    const std::uint64_t before = one->state_hash();
    std::string expected;
    try {
      expected = std::to_string(learning_room(seed, text).state_hash());
    } catch (const InputError& error) {
      expected = error.what();
    }
    try {
      one->reset(seed);
      EXPECT_EQ(std::to_string(one->state_hash()), expected);
    } catch (const InputError& error) {
      ++refused;
      // Of several populations without room the loader reports each.
      EXPECT_TRUE(expected.starts_with(error.what())) << expected << "\n" << error.what();
      EXPECT_EQ(one->state_hash(), before);
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 39);
}

using Starts = std::vector<std::pair<Model, Pose>>;

TEST(Starts, ModelsBeginWhereTheProgramPlacesThem) {
  constexpr Pose k_robot{1.5, -2.25, 0, 0.5};
  constexpr Pose k_pillar{-1, 3.25, 0, 1};
  constexpr Pose k_wall{-3.5, 0, 0, 0};
  Simulation one = learning_room(3);
  const Starts starts{{one.find("r1"), k_robot}, {one.find("pillar2"), k_pillar}, {one.find("w"), k_wall}};
  for (int i = 0; i < 10; ++i) one.step();
  one.reset(11, starts);
  const Simulation plain = learning_room(11);
  EXPECT_EQ(one.tick(), 0u);
  EXPECT_EQ(one.seed(), 11u);
  EXPECT_EQ(one.find("r1").pose(), k_robot);
  EXPECT_EQ(one.find("r1").estimate(), Pose()) << "odometry begins at the start";
  EXPECT_EQ(one.find("pillar2").pose(), k_pillar);
  EXPECT_EQ(one.find("w").pose(), k_wall);
  for (const char* name : {"r0", "pillar0", "other1", "goal3", "e"})
    EXPECT_EQ(one.world().view().pose(one.find(name).id()), plain.world().view().pose(one.find(name).id()))
        << name;

  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < 30; ++i) {
    one.step();
    hashes.push_back(one.state_hash());
  }
  Simulation ranks =
      Simulation::from_text(std::string(k_learning_room), "room.json", {.threads = 2, .ranks = 3});
  ranks.reset(
      11, Starts{{ranks.find("r1"), k_robot}, {ranks.find("pillar2"), k_pillar}, {ranks.find("w"), k_wall}});
  one.reset();
  for (const std::uint64_t hash : hashes)
    for (Simulation* each : {&one, &ranks}) {
      each->step();
      ASSERT_EQ(each->state_hash(), hash) << "reset() returns to the starts; ranks get them";
    }
  EXPECT_EQ(one.another(12, 1).state_hash(), learning_room(12).state_hash());
  EXPECT_EQ(one.another(12, 1).find("w").pose(), plain.world().view().pose(one.find("w").id()));
  one.reset(11);
  EXPECT_EQ(one.state_hash(), plain.state_hash());
  EXPECT_EQ(one.find("w").pose(), plain.world().view().pose(one.find("w").id()));
}

TEST(Starts, SayWhatIsWrong) {
  std::string text(k_learning_room);
  text.insert(text.find("\"types\""), "\"bounds_m\": [[-5, -5], [5, 5]],\n");
  text.insert(text.find("\"devices\""), "\"parts\": [{\"name\": \"head\", \"size_m\": [0.1, 0.1, 0.1]}],\n");
  text.replace(text.find("\"count\": 2"), 10, "\"count\": 2, \"reserve\": 1");
  Simulation one = learning_room(3, text);
  Simulation other = learning_room(3, text);
  one.step();
  const std::uint64_t before = one.state_hash();
  const auto reset = [&](const Model& model, const Pose& pose) {
    return [&one, starts = Starts{{model, pose}}] { one.reset(4, starts); };
  };
  EXPECT_THAT(reset(one.find("r0"), {6, 0, 0, 0}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("\"r0\" cannot be placed at x 6, y 0")));
  EXPECT_THAT(reset(one.find("r0"), {0, 0, 0, NAN}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("the numbers must be finite")));
  EXPECT_THAT(
      reset(one.find("other2"), {0, 0, 0, 0}),
      ThrowsMessage<std::invalid_argument>(HasSubstr(
          "it is not in the world at the start, because it is in the reserve of the population \"other\"")));
  EXPECT_THAT(
      reset(one.find("r0.head"), {0, 0, 0, 0}),
      ThrowsMessage<std::logic_error>(HasSubstr("is a part of \"r0\": use the model \"r0\" instead")));
  EXPECT_THAT(reset(other.find("r0"), {0, 0, 0, 0}),
              ThrowsMessage<std::logic_error>(HasSubstr("a model of another simulation")));
  EXPECT_EQ(one.tick(), 1u);
  EXPECT_EQ(one.state_hash(), before);
}

TEST(BatchEnv, CopiesAreTheWorldAlone) {
  const Simulation world = learning_room();
  for (std::size_t copy = 0; copy < 3; ++copy) {
    // The same world alone: its learning robots have no controller, and are told the same.
    std::string text(k_learning_room);
    Simulation alone = learning_room(3 + copy, text);
    Swarm swarm = alone.swarm("r");
    swarm.subscribe();
    std::vector<std::uint8_t> learns(alone.world().view().rows());
    for (const BodyId id : swarm.ids()) learns[alone.world().view().row(id).index()] = 1;
    alone.world().on_decide([&](const auto&, const auto& controller, const engine::DecideBatch& decide) {
      std::vector<Row> others;
      for (const Row row : decide.rows)
        if (learns[row.index()] == 0) others.push_back(row);
      engine::DecideBatch some = decide;
      some.rows = others;
      if (!others.empty()) controller.kind->decide(controller.data, some);
    });
    BatchEnv own(world, spec_of(3));  // all copies of it are driven, and one is looked at
    own.reset();
    alone.step();
    for (std::size_t step = 0; step < 15; ++step) {
      EXPECT_EQ(own.simulation(copy).state_hash(), alone.state_hash())
          << "copy " << copy << ", step " << step;
      std::vector<float> ranges(4 * 12);
      swarm.ranges(ranges);
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < 12; ++k)
          EXPECT_EQ(own.floats(0, "see")[(copy * 4 + i) * 22 + k], ranges[i * 12 + k] * 0.5F);
      act(own, step);
      std::vector<Model::Speed> speeds;
      for (std::size_t i = 0; i < 4; ++i) {
        const bool is_finished = own.terminated(0)[copy * 4 + i] != 0;
        const auto asked = [&](std::size_t column, double low, double high) {
          return low + (action_of(step, i, column) + 1) * 0.5 * (high - low);
        };
        speeds.push_back(is_finished ? Model::Speed() : Model::Speed{asked(0, 0, 0.5), 0, asked(1, -1, 1)});
        if (is_finished) continue;
        Model robot = alone.model(swarm.ids()[i]);
        models::LedCommand& lamp = robot.command<models::LedCommand>("lamp");
        lamp.red = static_cast<float>(asked(2, 0, 1));
        lamp.shows = asked(3, 0, 1) >= 0.5;
      }
      swarm.set_speeds(speeds);
      own.step();
      alone.step();
      alone.step();
    }
  }
}

/// A collective controller that commands a speed which tells how many robots it decides for.
struct Counts {
  void operator()(const engine::DecideBatch& batch) const {
    for (std::size_t i = 0; i < batch.size(); ++i)
      batch.command(i).x = 0.001 * static_cast<double>(batch.size());
  }
};

TEST(BatchEnv, CollectiveControllersDecideForAllRobotsTogether) {
  engine::Registry registry = make_registry();
  registry.controllers.push_back(engine::make_controller_kind<Counts>("counts", "for this test"));
  registry.controllers.back().is_collective = true;
  const Simulation world = Simulation::from_text(
      R"({"troupe": 1, "types": {"bot": {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"},
          "controller": {"kind": "counts"}}},
          "populations": [{"name": "r", "type": "bot", "count": 130,
                           "place": {"rule": "grid", "region_m": [[0, 0], [20, 20]], "pitch_m": 1}}]})",
      "counts.json", {.threads = 1}, std::move(registry));
  for (const std::string learning : {"r0", "bot"}) {
    BatchEnv batch(world, {.teams = {{.name = "team", .robots = learning}}});
    batch.reset();
    const engine::World& copy = batch.simulation(0).world();
    ASSERT_EQ(copy.view().commands().size(), 130u);
    for (const engine::Command& command : copy.view().commands()) {
      const Row row(static_cast<std::size_t>(&command - copy.view().commands().data()));
      const bool learns = learning == "bot" || copy.spec().name(copy.view().body(row)) == "r0";
      EXPECT_EQ(command.x, learns ? 0 : 0.001 * 129) << copy.spec().name(copy.view().body(row));
    }
  }
}

/// A controller that throws an exception once, in the call with the number `fails_at`.
struct Fails {
  static inline int calls = 0;
  static inline int fails_at = 0;
  void operator()(const engine::DecideBatch&) const {
    if (++calls == fails_at) throw std::runtime_error("planted");
  }
};

TEST(BatchEnv, ACopyThatFailedMustBeReset) {
  engine::Registry registry = make_registry();
  registry.controllers.push_back(engine::make_controller_kind<Fails>("fails", "for this test"));
  const Simulation world = Simulation::from_text(
      R"({"troupe": 1, "seed": 3, "types": {"bot": {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"},
          "controller": {"kind": "fails"}}},
          "models": [{"name": "r", "type": "bot"}, {"name": "other", "type": "bot", "pose": {"y_m": 1}}]})",
      "fails.json", {.threads = 1}, std::move(registry));
  BatchEnv batch(world, {.copies = 2, .threads = 1, .teams = {{.name = "team", .robots = "r"}}});
  batch.reset();
  Fails::fails_at = Fails::calls + 2;  // in the second copy
  EXPECT_THAT([&] { batch.step(); }, ThrowsMessage<engine::StepError>(HasSubstr("planted")));
  const std::uint64_t before = batch.simulation(0).state_hash();
  EXPECT_THAT([&] { batch.step(); },
              ThrowsMessage<std::logic_error>(HasSubstr("step(): the last step or reset of copy 1 (counted "
                                                        "from 0) failed: reset this copy first")));
  EXPECT_EQ(batch.simulation(0).state_hash(), before);
  batch.step(std::vector<std::uint8_t>{0, 1});
  EXPECT_EQ(batch.simulation(1).tick(), 1u);
  batch.step();
  EXPECT_EQ(batch.simulation(1).tick(), 2u);
}

// A worker thread that steps the copies must not start another loop over them.
TEST(BatchEnv, CallbacksMayNotStepTheBatch) {
  const Simulation world = learning_room();
  for (const unsigned threads : {1u, 2u}) {
    BatchEnv batch(world, spec_of(2, threads));
    batch.reset();
    for (const std::string call : {"step()", "reset()"}) {
      batch.simulation(1).on_tick([&](Simulation&) { call == "step()" ? batch.step() : batch.reset(); });
      EXPECT_THAT([&] { batch.step(); },
                  ThrowsMessage<std::logic_error>(call + " of a batch is not allowed in a callback of one of "
                                                         "its simulations: call it outside the callback"));
      batch.simulation(1).on_tick(nullptr);
      batch.reset();
      EXPECT_EQ(batch.simulation(1).tick(), 1u);
    }
  }
}

TEST(BatchEnv, DoesNotDependOnTheRowsOfRobots) {
  const Simulation world = learning_room();
  BatchEnv plain(world, spec_of(2));
  BatchEnv shuffled(world, spec_of(2));
  plain.reset();
  shuffled.reset();
  for (std::size_t step = 0; step < 15; ++step) {
    for (std::size_t copy = 0; copy < 2; ++copy) shuffled.simulation(copy).world().shuffle_rows(step);
    for (BatchEnv* batch : {&plain, &shuffled}) {
      act(*batch, step);
      batch->step();
    }
    EXPECT_EQ(given(shuffled), given(plain)) << "step " << step;
    for (std::size_t copy = 0; copy < 2; ++copy)
      EXPECT_EQ(shuffled.simulation(copy).state_hash(), plain.simulation(copy).state_hash());
  }
}

TEST(BatchEnv, ThreadsAndOtherCopiesDoNotShow) {
  const Simulation world = learning_room();
  std::vector<std::vector<std::byte>> runs;
  for (const unsigned threads : {1u, 2u, 5u}) {
    BatchEnv batch(world, spec_of(40, threads));
    batch.reset();
    std::vector<std::byte> all;
    for (std::size_t step = 0; step < 45; ++step) {  // episodes have 20 steps: each copy begins a third one
      act(batch, step);
      const std::vector<std::uint8_t> over(batch.over().begin(), batch.over().end());
      batch.step(over);
      const std::vector<std::byte> now = given(batch);
      all.insert(all.end(), now.begin(), now.end());
    }
    runs.push_back(std::move(all));
  }
  EXPECT_TRUE(runs[0] == runs[1]);
  EXPECT_TRUE(runs[0] == runs[2]);
}

TEST(BatchEnv, TellsWhatIsThere) {
  BatchEnv batch(learning_room(), spec_of(2));
  batch.reset();
  act(batch, 0);
  const double before = batch.floats(0, "goal")[2];
  batch.step();
  const engine::World& world = batch.simulation(0).world();
  const auto state = batch.floats(0, "state");
  const Row row = world.view().row(world.state().names.find("r0"));
  const Pose pose = world.view().poses()[row.index()];
  EXPECT_EQ(state[0], static_cast<float>(pose.x));
  EXPECT_EQ(state[1], static_cast<float>(pose.y));
  EXPECT_FLOAT_EQ(state[2], static_cast<float>(std::cos(pose.heading)));
  EXPECT_EQ(state[4], static_cast<float>(world.view().estimate(row).x));
  EXPECT_EQ(state[8], static_cast<float>(world.view().velocities()[row.index()].x));

  const auto goal = batch.floats(0, "goal");
  const Pose there = world.view().pose(world.state().names.find("goal0"));
  const double distance = std::hypot(there.x - pose.x, there.y - pose.y);
  EXPECT_FLOAT_EQ(goal[2], static_cast<float>(distance));
  const double bearing = std::atan2(there.y - pose.y, there.x - pose.x) - pose.heading;
  EXPECT_NEAR(goal[0], distance * std::cos(bearing), 1e-5);
  EXPECT_NEAR(goal[1], distance * std::sin(bearing), 1e-5);
  EXPECT_FLOAT_EQ(goal[3], 38.0F / 40);

  // Brute force, over all robots of the type, the others too.
  std::vector<std::pair<double, Row>> all;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    if (world.view().type(Row(r)).drive && Row(r) != row)
      all.emplace_back((world.view().poses()[r].position() - pose.position()).norm(), Row(r));
  std::ranges::sort(all, {}, [](const auto& each) { return each.first; });
  const auto see = batch.floats(0, "see");
  ASSERT_EQ(all.size(), 5u);
  for (std::size_t k = 0; k < 2; ++k) {
    const float* near = &see[12 + 5 * k];
    const bool is_near = all[k].first <= 4;
    EXPECT_EQ(near[4], is_near ? 1 : 0);
    if (!is_near) continue;
    EXPECT_NEAR(std::hypot(near[0], near[1]), all[k].first, 1e-5);
    EXPECT_NEAR(std::atan2(near[3], near[2]),
                std::remainder(world.view().poses()[all[k].second.index()].heading - pose.heading, 2 * M_PI),
                1e-5);
  }
  EXPECT_FLOAT_EQ(static_cast<float>(batch.rewards(0)[0]),
                  static_cast<float>(before - goal[2] + 0.25 * batch.measures()[0]));
}

TEST(BatchEnv, MeasuresAreNamedWithOrWithoutTheirUnits) {
  BatchSpec spec = spec_of(1);
  spec.measures = {"mean_nearest_distance", "displacement:r"};
  spec.teams[0].ends.clear();
  for (const char* name : {"displacement:r", "displacement_m:r"}) {
    spec.teams[0].rewards = {{.of = {.measure = name}}};
    BatchEnv batch(learning_room(), spec);
    batch.reset();
    act(batch, 0);
    batch.step();
    EXPECT_EQ(batch.measure_columns()[1], "displacement_m:r");
    EXPECT_GT(batch.measures()[1], 0);
    EXPECT_EQ(batch.rewards(0)[0], batch.measures()[1]) << name;
  }
}

TEST(BatchEnv, ARewardThatIsNotFiniteIsAnError) {
  BatchSpec spec = spec_of(2);
  spec.measures = {"mean_nearest_distance:r1"};  // NaN, because a group of one robot has no nearest robots
  for (const bool change : {false, true}) {
    spec.teams[0].rewards = {{.of = {.array = "goal", .column = 2}},
                             {.of = {.measure = "mean_nearest_distance:r1"}, .change = change}};
    BatchEnv batch(learning_room(), spec);
    batch.reset();
    EXPECT_EQ(batch.rewards(0)[0], 0);
    EXPECT_THAT(
        [&] { batch.step(); },
        ThrowsMessage<engine::StepError>(HasSubstr(
            std::string("reward 1 of team \"bots\": the ") + (change ? "change" : "value") +
            " of measure \"mean_nearest_distance_m:r1\" is nan for robot \"r0\" in copy 0 at tick 3")));
  }
}

TEST(BatchEnv, ARobotThatArrivesIsFinishedAndStandsStill) {
  BatchSpec spec = spec_of(1);
  spec.seconds = 1000;
  spec.teams[0].ends[0].below = 1e3;  // at once
  BatchEnv batch(learning_room(), spec);
  batch.reset();
  EXPECT_EQ(batch.over()[0], 0);
  act(batch, 0);
  batch.step();
  EXPECT_EQ(batch.terminated(0)[2], 1);
  EXPECT_GT(batch.rewards(0)[2], 4);
  EXPECT_EQ(batch.over()[0], 1);
  EXPECT_EQ(batch.truncated()[0], 0);
  for (int i = 0; i < 10; ++i) batch.step();
  EXPECT_EQ(batch.rewards(0)[2], 0);
  EXPECT_EQ(batch.floats(0, "state")[2 * 12 + 8], 0) << "its speed";
  const std::uint64_t seed = batch.seeds()[0];
  batch.step(batch.over());
  EXPECT_NE(batch.seeds()[0], seed);
  EXPECT_EQ(batch.terminated(0)[2], 0);
  EXPECT_EQ(batch.rewards(0)[2], 0);
  EXPECT_EQ(batch.simulation(0).tick(), 1);
}

TEST(BatchEnv, ATeamOfOneRobotThatHasTheNameOfItsType) {
  const Simulation world = Simulation::from_text(
      R"({"troupe": 1, "types": {"bot": {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"}},
                                 "wall": {"size_m": [0.1, 3, 0.5]}},
          "models": [{"name": "first", "type": "bot"}, {"name": "bot", "type": "bot", "pose": {"y_m": 1}},
                     {"name": "wall", "type": "wall", "pose": {"x_m": 2}}]})",
      "names.json", {.threads = 1});
  const auto names = [&world](const char* robot) {
    return BatchEnv(world, {.teams = {{.name = "team", .robot = robot}}}).names(0);
  };
  EXPECT_EQ(names("bot"), (std::vector<std::string>{"bot"}));
  EXPECT_EQ(names(""), (std::vector<std::string>{"first", "bot"}));
  EXPECT_THAT([&] { names("wall"); },
              ThrowsMessage<std::out_of_range>(HasSubstr("\"wall\" is not a robot: it has no drive")));
  EXPECT_THAT([&] { names("bots"); },
              ThrowsMessage<std::out_of_range>(HasSubstr("no model \"bots\" in names.json")));
}

TEST(BatchEnv, CopiesAreResetAlone) {
  BatchEnv batch(learning_room(), spec_of(3));
  batch.reset();
  act(batch, 0);
  batch.step();
  const std::vector<std::uint64_t> before{batch.simulation(0).state_hash(), batch.simulation(2).state_hash()};
  const std::vector<std::uint8_t> which{0, 1, 0};
  const std::vector<std::optional<std::uint64_t>> seeds{{}, 77, {}};
  batch.reset(which, seeds);
  EXPECT_EQ(batch.simulation(0).state_hash(), before[0]);
  EXPECT_EQ(batch.simulation(2).state_hash(), before[1]);
  EXPECT_EQ(batch.simulation(1).seed(), 77u);
  Simulation alone = learning_room(77);
  alone.step();
  EXPECT_EQ(batch.simulation(1).hashes().pose, alone.hashes().pose);
}

TEST(BatchEnv, BodiesBeginWhereTheProgramPlacesThem) {
  BatchSpec spec = spec_of(2);
  BatchEnv plain(learning_room(), spec);
  spec.starts = {"r0", "goal"};
  BatchEnv batch(learning_room(), spec);
  EXPECT_EQ(batch.starts("r0").size(), 2 * 3u);
  const std::span<double> goals = batch.starts("goal");
  EXPECT_EQ(goals.size(), 2 * 4 * 3u);
  EXPECT_TRUE(std::isnan(goals[0]));
  const auto hashes = [](BatchEnv& of) {
    return std::pair(of.simulation(0).state_hash(), of.simulation(1).state_hash());
  };
  const auto begins_as_plain = [&] {
    const std::vector<std::uint64_t> next = batch.next_seeds();
    batch.reset();
    plain.reset();
    EXPECT_EQ(next, std::vector(batch.seeds().begin(), batch.seeds().end()));
    EXPECT_EQ(hashes(batch).first, hashes(plain).first);
    return hashes(batch).second == hashes(plain).second;
  };
  EXPECT_TRUE(begins_as_plain());
  constexpr Pose k_goal{-1.5, 2.5, 0, 0.25};
  std::ranges::copy(std::array{k_goal.x, k_goal.y, k_goal.heading}, goals.begin() + (4 + 2) * 3);
  std::ranges::copy(std::array{2.0, 1.0, -0.5}, batch.starts("r0").begin() + 3);
  for (int episode = 0; episode < 2; ++episode) {
    EXPECT_FALSE(begins_as_plain());
    EXPECT_EQ(batch.simulation(1).find("goal2").pose(), k_goal);
    EXPECT_EQ(batch.simulation(1).find("r0").pose(), (Pose{2, 1, 0, -0.5}))
        << "robots rest in the first tick";
    act(batch, 1);
    act(plain, 1);
    batch.step();
    plain.step();
  }
  std::ranges::fill(goals, NAN);
  std::ranges::fill(batch.starts("r0"), NAN);
  EXPECT_TRUE(begins_as_plain()) << "without starts, the world places all bodies again";

  const auto before = hashes(batch);
  goals[3 * 3] = 1;
  const std::vector<std::uint8_t> first{1, 0};
  EXPECT_THAT([&] { batch.step(first); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(
                  "the start of \"goal3\" in copy 0 (counted from 0) is x 1, y nan (m), heading nan (rad)")));
  EXPECT_EQ(hashes(batch), before);
  EXPECT_THAT([&] { batch.starts("r"); }, ThrowsMessage<std::out_of_range>(
                                              HasSubstr("unknown entry of `starts` \"r\"; known: goal, r0")));
}

/// A device with a command that is a bool, and with the state that the command has.
struct Siren {
  struct Command {
    bool blows = false;
    TROUPE_FIELDS(blows)
  };
  struct State {
    std::uint8_t heard = 0;
    TROUPE_FIELDS(heard)
  };
  void act(const engine::DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i)
      batch.state.as<State>(batch.slot(i)).heard =
          batch.commands->cell<std::uint8_t>(batch.slot(i), 0)[0];  // as bytes, also those that are no bool
  }
};

TEST(BatchEnv, AnActionForABoolIsZeroOrOne) {
  engine::Registry registry = make_registry();
  registry.devices.push_back(engine::make_device_kind<Siren>("siren", "makes noise"));
  const Simulation world = Simulation::from_text(R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2],
    "drive": {"kind": "diff"}, "devices": [{"name": "siren", "kind": "siren"}]}},
    "models": [{"name": "r0", "type": "bot"}]})",
                                                 "siren.json", {.threads = 1}, registry);
  BatchTeam team{.name = "bots"};
  team.arrays = {{"heard", {{.of = Of::reading, .device = "siren", .field = "heard"}}}};
  team.actions = {{.device = "siren", .command = "blows", .low = -5, .high = 9}};
  BatchEnv batch(world, {.teams = {team}});
  batch.reset();
  for (const auto& [action, heard] : {std::pair(1.0, 1.0f), {-1.0, 0.0f}, {0.0, 1.0f}}) {
    batch.actions(0)[0] = action;
    batch.step();
    EXPECT_EQ(batch.floats(0, "heard")[0], heard) << action;
  }
}

TEST(BatchEnv, SaysWhatIsWrong) {
  const Simulation world = learning_room();
  const auto make = [&](auto&& change) {
    return [&world, change] {
      BatchSpec spec = spec_of(2);
      change(spec, spec.teams[0]);
      const BatchEnv batch(world, spec);
    };
  };
  const auto is_wrong = [&]<class Error>(Error*, auto&& change, const std::string& text) {
    EXPECT_THAT(make(change), ThrowsMessage<Error>(HasSubstr(text)));
  };
  constexpr std::invalid_argument* k_argument = nullptr;
  constexpr std::out_of_range* k_name = nullptr;
  is_wrong(
      k_argument, [](auto& s, auto&) { s.copies = 0; }, "has 0 copies of the world: give 1 to 1000000");
  is_wrong(
      k_argument, [](auto& s, auto&) { s.ticks = 0; }, "has 0 ticks: give 1 or more");
  is_wrong(
      k_argument, [](auto& s, auto&) { s.seconds = NAN; }, "episodes are nan s long");
  is_wrong(
      k_argument, [](auto& s, auto&) { s.teams.clear(); }, "has no teams");
  is_wrong(
      k_argument, [](auto& s, auto& t) { s.teams.push_back(t); },
      "team \"bots\" occurs twice: names must be unique");
  is_wrong(
      k_argument,
      [](auto& s, auto& t) {
        s.teams.push_back(t);
        s.teams[1].name = "more";
      },
      "\"r0\" is in two teams");
  is_wrong(
      k_name, [](auto&, auto& t) { t.robots = "q"; }, "unknown type or population of robots \"q\"");
  is_wrong(
      k_name, [](auto&, auto& t) { t.arrays[0].parts[0].field = "rangs"; }, "did you mean \"ranges\"?");
  is_wrong(
      k_argument,
      [](auto&, auto& t) {
        t.arrays[0].parts[0].device = "wander/0";
        t.arrays[0].parts[0].field = "avoid_updates";
      },
      "team \"bots\" observes \"wander/0\", the memory of a controller, but the controllers of its robots do "
      "not run: give the name of a device");
  is_wrong(
      k_name, [](auto&, auto& t) { t.arrays[2].parts[0].name = "gaol"; },
      "there is no model \"gaol0\", which would be the target of robot \"r0\"; give the name of one model");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.arrays[2].parts[0].name.clear(); },
      "team \"bots\": a part \"target\" has no name: give the name of its target");
  is_wrong(
      k_name, [](auto&, auto& t) { t.actions[0].command = "forwards"; },
      "an action without a device commands the drive: unknown command \"forwards\"");
  is_wrong(
      k_name, [](auto&, auto& t) { t.actions[2].command = "reed"; },
      "device \"lamp\": unknown command field \"reed\"");
  for (const auto& range : {std::pair(0.0, HUGE_VAL), {double{NAN}, 1.0}, {-1e308, 1e308}})
    is_wrong(
        k_argument,
        [&range](auto&, auto& t) {
          t.actions[0].low = range.first;
          t.actions[0].high = range.second;
        },
        fmt::format("action \"forward\" of team \"bots\": low is {}, high is {}: give finite numbers whose "
                    "difference is finite",
                    range.first, range.second));
  is_wrong(
      k_argument, [](auto&, auto& t) { t.actions.push_back({.command = "forward"}); },
      "actions 0 and 4 of team \"bots\" (counted from 0) both set the command \"forward\" of the drive: give "
      "each "
      "command one action");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.actions.push_back({.device = "lamp", .command = "red"}); },
      "actions 2 and 4 of team \"bots\" (counted from 0) both set the command \"red\" of device \"lamp\"");
  is_wrong(
      k_name, [](auto&, auto& t) { t.rewards[0].of.array = "gold"; },
      "team \"bots\": unknown array \"gold\"");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.rewards[0].of = {}; },
      "reward of team \"bots\": has neither an array nor a measure: give the name of an array and a column, "
      "or the name of a measure");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.rewards[0].of.column = 4; },
      "there is no column 4 in array \"goal\", which has 4 columns");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.rewards[0].weight = NAN; },
      "reward of team \"bots\": weight is nan: give a finite number");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.ends.push_back({.of = {.array = "goal"}, .below = NAN}); },
      "end of team \"bots\": the threshold is nan, reward is 0: give a threshold that is a number");
  is_wrong(
      k_argument,
      [](auto&, auto& t) {
        t.ends.push_back({.of = {.array = "goal"}, .reward = -std::numeric_limits<double>::infinity()});
      },
      "reward is -inf: give a threshold that is a number, and a finite reward");
  is_wrong(
      k_name, [](auto&, auto& t) { t.rewards[1].of.measure = "stalls"; },
      "reward of team \"bots\": the measure \"stalls\" is not in the list `measures` of the task, which "
      "contains ");
  is_wrong(  // the beginning of a name
      k_name, [](auto&, auto& t) { t.rewards[1].of.measure = "mean"; },
      "the measure \"mean\" is not in the list `measures` of the task");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.arrays[1].raw = true; },
      "an array with \"raw\" must have exactly one part");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.arrays[0].parts[1].count = 0; },
      "the part \"nearest\" has the count 0");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.arrays[0].parts[1].range_m = 0; },
      "array \"see\" of team \"bots\": range_m is 0: give a distance above 0");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.arrays[0].parts[0].scale = HUGE_VAL; },
      "array \"see\" of team \"bots\": scale is inf: give a finite number");
  is_wrong(
      k_argument, [](auto&, auto& t) { t.arrays[0].parts.clear(); },
      "array \"see\" of team \"bots\" has no parts: give one or more");

  is_wrong(
      k_name, [](auto& s, auto&) { s.starts = {"none"}; },
      "starts: the world has no model, population or type \"none\" with bodies");
  is_wrong(
      k_argument,
      [](auto& s, auto&) {
        s.starts = {"bot", "r1"};
      },
      "starts: \"r1\" is in two entries: list each body once");

  BatchEnv batch(world, spec_of(2));
  EXPECT_THAT([&] { batch.step(); }, ThrowsMessage<std::logic_error>(HasSubstr("call reset() before")));
  const std::vector<std::uint8_t> second{0, 1};
  EXPECT_THAT([&] { batch.reset(second); },
              ThrowsMessage<std::logic_error>(
                  HasSubstr("copy 0 (counted from 0) has not begun an episode: reset all copies first")));
  batch.reset();
  const std::vector<std::optional<std::uint64_t>> three_seeds(3, 7);
  EXPECT_THAT(
      [&] { batch.reset({}, three_seeds); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("`seeds` has 3 elements: give 2, one per copy")));
  EXPECT_THAT(
      [&] { batch.step(std::vector<std::uint8_t>(3)); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("`begins` has 3 elements: give 2, one per copy")));
  const std::uint64_t before = batch.simulation(0).state_hash();
  batch.actions(0)[4 * 4 + 5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { batch.step(); }, ThrowsMessage<std::invalid_argument>(HasSubstr(
                                         "action 1 of \"r1\" in copy 1 (both counted from 0) is nan")));
  EXPECT_EQ(batch.simulation(0).state_hash(), before);
  const std::vector<std::uint8_t> three(3);
  EXPECT_THAT([&] { batch.reset(three); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("has 3 elements: give 2, one per copy")));
}

}  // namespace
}  // namespace troupe::batch_env_test
