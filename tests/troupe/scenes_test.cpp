// worlds/beeclust.json, coverage.json, chain.json, brazil_nut.json, segregation.json and harvest.json: the
// experiments of docs/scenes.md, each with several seeds, and single decisions of their controllers.

#include "engine/world/world.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/measures.hpp"
#include "troupe/troupe.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::scenes_test {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

const std::uint64_t k_seeds = test::scene_seeds();
const std::uint64_t k_few_seeds =
    std::min<std::uint64_t>(k_seeds, 4);  // of scenes that take long: scripts/scenes has all ten

Simulation scene(const char* name, std::uint64_t seed, Settings settings = {}) {
  SimulationOptions options;
  options.threads = 1;
  options.seed = seed;
  options.set = std::move(settings);
  return Simulation(test::source_dir() / "worlds" / name, options);
}

/// The means of the world's measures over (from, to], s, looked at every second.
std::vector<double> means_between(Simulation& simulation, Measures& measures, double from, double to) {
  std::vector<double> sums(measures.columns().size(), 0);
  double count = 0;
  while (simulation.time_s() < to - 1e-9) {
    simulation.step();
    measures.see();
    if (simulation.tick() % 10 != 0 || simulation.time_s() <= from) continue;
    const std::vector<double> values = measures.values();
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += values[i];
    ++count;
  }
  for (double& sum : sums) sum /= count;
  return sums;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// A number that the controller of this kind keeps for a body.
template <class T>
T memory_of(const engine::World& world, BodyId body, std::string_view component, std::string_view field) {
  for (const engine::StateTable& table : world.tables()) {
    if (table.component() != component) continue;
    const auto row = std::ranges::find(table.ids(), body);
    if (row == table.ids().end()) continue;
    for (std::size_t f = 0; f < table.fields().size(); ++f)
      if (table.fields()[f].name == field)
        return table.cell<T>(static_cast<std::size_t>(row - table.ids().begin()), f)[0];
  }
  throw std::out_of_range(std::string(field));
}

// ---- beeclust.json

TEST(BeeclustScene, TheSwarmGathersBelowTheBrighterLampAndFollowsIt) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 180,000 ticks";
  std::vector<double> bright, dim, after;
  for (std::uint64_t seed = 1; seed <= k_seeds; ++seed) {
    Simulation simulation = scene("beeclust.json", seed);
    Measures measures(simulation);  // left, right
    const std::vector<double> before = means_between(simulation, measures, 600, 900);
    bright.push_back(before[0]);
    dim.push_back(before[1]);
    after.push_back(means_between(simulation, measures, 1500, 1800)[1]);
    EXPECT_GT(bright.back(), 0.6) << "seed " << seed;
    EXPECT_GT(bright.back(), 3 * dim.back()) << "seed " << seed;
    EXPECT_GT(after.back(), 0.5) << "seed " << seed << ", where the lamps have changed places";
  }
  EXPECT_NEAR(mean(bright), 0.76, 0.06);
  EXPECT_NEAR(mean(dim), 0.10, 0.04);
  EXPECT_NEAR(mean(after), 0.70, 0.10);
}

TEST(BeeclustScene, WhereNoRobotWaitsTheShareIsThatOfTheGround) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 36,000 ticks";
  std::vector<double> left;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Simulation simulation = scene("beeclust.json", seed, {{"/types/robot/controller/max_wait_s", "0"}});
    Measures measures(simulation);
    left.push_back(means_between(simulation, measures, 0, 1800)[0]);
  }
  const double circle = 3.14159 * 0.5 * 0.5;
  EXPECT_NEAR(mean(left), circle / (2.1 * 1.2), 0.04);
}

class BeeclustByHand : public test::ScratchTest {
 protected:
  /// Two robots 0.4 m apart that go straight at each other, on ground of some grey.
  Simulation duel(const std::string& grey) {
    return Simulation(write("duel.json", R"({"troupe": 1, "types": {
      "robot": {"size_m": [0.06, 0.06, 0.06], "drive": {"kind": "diff"},
        "sensors": [{"name": "eye", "kind": "ground", "floor": [)" +
                                             grey + ", " + grey + ", " + grey + R"(]},
                    {"name": "radio", "kind": "radio", "range_m": 1, "payload": 1},
                    {"name": "ir", "kind": "ranger", "pose": {"z_m": 0.04}, "transducers": [{"range_max_m": 0.2, "fov_deg": 180, "samples": 9}]}],
        "controller": {"kind": "beeclust"}},
      "wall": {"size_m": [0.1, 2, 0.2]}},
      "models": [{"name": "a", "type": "robot", "pose": {"x_m": -0.2}},
                 {"name": "b", "type": "robot", "pose": {"x_m": 0.2, "heading_deg": 180}},
                 {"name": "lone", "type": "robot", "pose": {"x_m": 0, "y_m": 3}},
                 {"name": "wall", "type": "wall", "pose": {"x_m": 0.4, "y_m": 3}}]})"),
                      {.threads = 1});
  }
  static double distance(const Simulation& simulation) {
    return simulation.world().view().pose(simulation.world().state().names.find("b")).x -
           simulation.world().view().pose(simulation.world().state().names.find("a")).x;
  }
};

TEST_F(BeeclustByHand, WhoMeetsWaitsByTheBrightnessOfTheGround) {
  Simulation simulation = duel("0.5");
  const engine::World& world = simulation.world();
  const BodyId a = world.state().names.find("a");
  std::uint32_t longest = 0;
  // They meet where 0.12 m are left: after (0.4 - 0.12) m at 0.1 m/s each, 14 ticks, and some to hear and to
  // stop.
  for (int tick = 0; tick < 20; ++tick) {
    simulation.step();
    longest = std::max(longest, memory_of<std::uint32_t>(world, a, "beeclust/0", "wait_updates"));
  }
  // 60 s * 0.25 / (0.25 + 0.22) = 31.91 s.
  EXPECT_EQ(longest, 319u);
  const double apart = distance(simulation);
  EXPECT_GT(apart, 0.06 + 0.005);
  EXPECT_LE(apart, 0.12);
  for (int tick = 0; tick < 300; ++tick) simulation.step();
  EXPECT_EQ(distance(simulation), apart) << "they stand for 32 s";
  for (int tick = 0; tick < 100; ++tick) simulation.step();
  EXPECT_GT(std::abs(distance(simulation) - apart) +
                std::abs(world.view().pose(a).y - world.view().pose(world.state().names.find("b")).y),
            0.1)
      << "and then go apart";
}

TEST_F(BeeclustByHand, NoRobotWaitsOnBlackGroundNorAtAWall) {
  for (const auto& [grey, name] : {std::pair("0", "a"), std::pair("1", "lone")}) {
    Simulation simulation = duel(grey);
    const engine::World& world = simulation.world();
    const BodyId body = world.state().names.find(name);
    bool has_turned = false;
    for (int tick = 0; tick < 60; ++tick) {
      simulation.step();
      EXPECT_EQ(memory_of<std::uint32_t>(world, body, "beeclust/0", "wait_updates"), 0u) << name;
      has_turned = has_turned || std::abs(world.view().pose(body).heading) > 1;
    }
    EXPECT_TRUE(has_turned) << name;
    EXPECT_LT(world.view().pose(body).x, 0.35 - 0.03) << "no farther than the wall";
  }
}

// ---- coverage.json

TEST(CoverageScene, SearchSlowsDownByTheShareOfTheRobotsThatFail) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 18,000 ticks";
  // Random search (Koopman): the ground that is left falls by exp(-k n t), with n robots that work.
  const auto rate = [](const char* share, std::vector<double>& at_60_s) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= k_seeds; ++seed) {
      Simulation simulation = scene("coverage.json", seed, {{"/at/0/disable/share", share}});
      Measures measures(simulation);
      means_between(simulation, measures, 0, 20);
      const double left_at_20_s = 1 - measures.value("coverage");
      means_between(simulation, measures, 20, 60);
      const double left_at_60_s = 1 - measures.value("coverage");
      at_60_s.push_back(1 - left_at_60_s);
      sum += std::log(left_at_20_s / left_at_60_s) / 40;
    }
    return sum / static_cast<double>(k_seeds);
  };
  std::vector<double> all, three_quarters, half;
  const double of_all = rate("0", all);
  EXPECT_NEAR(rate("0.25", three_quarters) / of_all, 0.75, 0.1);
  EXPECT_NEAR(rate("0.5", half) / of_all, 0.5, 0.1);
  // n v 4 c / (pi A): robots on random straight lines, whose cells of 0.5 m are 4 c / pi wide on average.
  // Turning at the walls and ways that are gone twice cost about a quarter.
  const double straight = 20 * 0.5 * 4 * 0.5 / (3.14159 * 144);
  EXPECT_LT(of_all, straight);
  EXPECT_GT(of_all, 0.65 * straight);
  EXPECT_NEAR(mean(all), 0.875, 0.02);
  EXPECT_NEAR(mean(three_quarters), 0.82, 0.03);
  EXPECT_NEAR(mean(half), 0.77, 0.03);
}

// ---- chain.json

TEST(ChainScene, APathLeadsFromTheNestToThePreyWhateverTheSeed) {
  if (test::k_slow_build) GTEST_SKIP() << "takes up to 500,000 ticks";
  for (std::uint64_t seed = 1; seed <= k_seeds; ++seed) {
    Simulation simulation = scene("chain.json", seed);
    const engine::World& world = simulation.world();
    simulation.run_for(5000);
    EXPECT_TRUE(simulation.stopped()) << "seed " << seed;
    for (int tick = 0; tick < 30; ++tick) simulation.step();  // the news goes a link a tick
    EXPECT_EQ(memory_of<std::uint8_t>(world, world.state().names.find("nest"), "chain/0", "path"), 1)
        << "seed " << seed;
    std::vector<std::pair<int, Vec2>> path;
    for (const std::string& name : simulation.robot_names()) {
      const BodyId body = world.state().names.find(name);
      if (memory_of<std::uint8_t>(world, body, "chain/0", "path") != 0)
        path.emplace_back(memory_of<std::uint8_t>(world, body, "chain/0", "number"),
                          world.view().pose(body).position());
    }
    const Vec2 nest = world.view().pose(world.state().names.find("nest")).position();
    const Vec2 prey = world.view().pose(world.state().names.find("prey")).position();
    // Links stand 0.6 m apart, and no more than 0.1 m farther, and hear 0.9 m far: two do not do for 2.5 m.
    EXPECT_GE(path.size(), 3u) << "seed " << seed;
    bool reaches_prey = false;
    for (const auto& [number, place] : path) {
      reaches_prey = reaches_prey || (place - prey).norm() <= 0.9;
      const bool has_inner = number == 1
                                 ? (place - nest).norm() <= 0.9
                                 : std::ranges::any_of(path, [&, n = number, p = place](const auto& other) {
                                     return other.first == n - 1 && (other.second - p).norm() <= 0.9;
                                   });
      EXPECT_TRUE(has_inner) << "seed " << seed << ", link " << number;
    }
    EXPECT_TRUE(reaches_prey) << "seed " << seed;
  }
}

TEST(ChainScene, TheFartherThePreyTheLongerItTakes) {
  if (test::k_slow_build) GTEST_SKIP() << "takes up to 1,000,000 ticks";
  const auto mean_time = [](const char* x_m) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= k_seeds; ++seed) {
      Simulation simulation = scene("chain.json", seed, {{"/models/5/pose/x_m", x_m}});
      simulation.run_for(5000);
      sum += simulation.time_s();
    }
    return sum / static_cast<double>(k_seeds);
  };
  const double near = mean_time("2");
  const double far = mean_time("3");
  EXPECT_LT(2 * near, far);
}

// ---- brazil_nut.json

double rank_errors(std::uint64_t seed, const Settings& settings) {
  Simulation simulation = scene("brazil_nut.json", seed, settings);
  Measures measures(simulation);
  return means_between(simulation, measures, 400, 600)[0];
}

TEST(BrazilNutScene, RobotsFormRingsByTheirSize) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 60,000 ticks";
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= k_seeds; ++seed) errors.push_back(rank_errors(seed, {}));
  EXPECT_LT(mean(errors), 0.01);
  EXPECT_LT(std::ranges::max(errors), 0.02);
}

TEST(BrazilNutScene, ErrorsFallSteeplyWithTheRatioOfSizes) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 60,000 ticks";
  std::vector<double> little, more;
  for (std::uint64_t seed = 1; seed <= std::min<std::uint64_t>(k_seeds, 5); ++seed) {
    little.push_back(rank_errors(
        seed, {{"/types/middle/controller/radius_m", "0.1"}, {"/types/large/controller/radius_m", "0.125"}}));
    more.push_back(rank_errors(
        seed, {{"/types/middle/controller/radius_m", "0.12"}, {"/types/large/controller/radius_m", "0.18"}}));
  }
  EXPECT_NEAR(mean(little), 0.094, 0.03);
  EXPECT_LT(3 * mean(more), mean(little)) << "0.25 more of the ratio: a third or less of the errors";
  EXPECT_GT(mean(more), 0.005) << "and still more of them than of ratio 2";
}

// ---- segregation.json

/// So many robots of each kind; measures of all of them: on black, on white.
Settings informed(const char* for_black, const char* for_white, const char* uninformed) {
  return {
      {"/populations/0/count", for_black},
      {"/populations/1/count", for_white},
      {"/populations/2/count", uninformed},
      {"/measures", R"([{"kind": "share_within", "center_m": [-0.75, 0], "radius_m": 0.6, "name": "black"},
                            {"kind": "share_within", "center_m": [0.75, 0], "radius_m": 0.6, "name": "white"}])"}};
}

/// The world's measures at the end, as means over 600 s.
std::vector<double> gathered(std::uint64_t seed, const Settings& settings) {
  Simulation simulation = scene("segregation.json", seed, settings);
  Measures measures(simulation);
  return means_between(simulation, measures, 3000, 3600);
}

TEST(SegregationScene, EachGathersOnTheGroundOfItsColour) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 144,000 ticks";
  for (std::uint64_t seed = 1; seed <= k_few_seeds; ++seed) {
    const std::vector<double> shares = gathered(seed, {});
    EXPECT_GT(shares[0], 0.85) << "seed " << seed << ", robots for black ground";
    EXPECT_GT(shares[1], 0.85) << "seed " << seed << ", robots for white ground";
  }
}

TEST(SegregationScene, WithNoRobotInformedTheSwarmGathersOnASiteAtRandom) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 360,000 ticks";
  std::size_t on_black = 0, on_one = 0;
  for (std::uint64_t seed = 1; seed <= k_seeds; ++seed) {
    const std::vector<double> shares = gathered(seed, informed("0", "0", "40"));
    on_one += std::ranges::max(shares) > 0.85;
    on_black += shares[0] > shares[1];
  }
  EXPECT_GE(on_one, k_seeds * 8 / 10) << "in an hour; the others share both sites still";
  EXPECT_GE(on_black, 1u);
  EXPECT_LT(on_black, k_seeds);
}

TEST(SegregationScene, AFewWhoAreInformedDecideWhereTheSwarmGathers) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 288,000 ticks";
  std::vector<double> few;
  for (std::uint64_t seed = 1; seed <= k_few_seeds; ++seed) {
    EXPECT_GT(gathered(seed, informed("12", "0", "28"))[0], 0.9) << "seed " << seed;
    few.push_back(gathered(seed, informed("4", "0", "36"))[0]);
  }
  EXPECT_GE(std::ranges::count_if(few, [](double share) { return share > 0.5; }) + 1, k_few_seeds);
}

class SegregationByHand : public test::ScratchTest {
 protected:
  /// `count` robots, a metre from one another on ground of some grey, that never leave it.
  Simulation crowd(const char* count, const char* grey, const char* controller, double range_m) {
    const std::string text = fmt::format(R"({{"troupe": 1, "types": {{
      "robot": {{"size_m": [0.06, 0.06, 0.06], "drive": {{"kind": "diff"}},
        "sensors": [{{"name": "eye", "kind": "ground", "floor": [{0}, {0}, {0}]}},
                    {{"name": "radio", "kind": "radio", "range_m": {1}, "payload": 1}},
                    {{"name": "ir", "kind": "ranger", "transducers": [{{"range_max_m": 0.2, "fov_deg": 180, "samples": 9}}]}}],
        "controller": {{"kind": "informed_aggregation", "enter_s": 0, "speed_mps": 0{2}}}}}}},
      "populations": [{{"name": "r", "type": "robot", "count": {3},
                       "place": {{"rule": "grid", "region_m": [[0, 0], [19.5, 19.5]], "pitch_m": 1}}}}]}})",
                                         grey, range_m, controller, count);
    return Simulation(write("crowd.json", text), {.threads = 1});
  }
  static std::size_t standing(const Simulation& simulation) {
    std::size_t count = 0;
    for (const std::string& name : simulation.robot_names())
      count += memory_of<std::uint8_t>(simulation.world(), simulation.world().state().names.find(name),
                                       "informed_aggregation/0", "does") == 2;
    return count;
  }
};

TEST_F(SegregationByHand, WhoStandsAloneLeavesAtItsRate) {
  Simulation simulation = crowd("400", "0", R"(, "leave_per_s": 0.2)", 0.1);
  simulation.run_for(0.5);
  EXPECT_GT(standing(simulation), 360u) << "they began on black ground";
  simulation.run_for(5.3);
  // They stand after two ticks, and leave in 56 more with a chance of 0.2 * 0.1 each; there is no ground on
  // which they would stop again. 0.98^56 of 400 is 129, with a standard deviation of 9.4.
  EXPECT_NEAR(static_cast<double>(standing(simulation)), 129, 30);
}

TEST_F(SegregationByHand, WhoHearsOthersStaysLonger) {
  Simulation simulation = crowd("400", "1", R"(, "leave_per_s": 0.2, "others": 1)", 1.1);
  simulation.run_for(5.8);
  // Until they hear one another, after a tick or two, 8 leave in a tick. Then of 324 with four neighbours
  // 0.2 e^-4 = 0.0037 per second leave, of 72 at the border 0.01, of those whom others left behind some more:
  // 7 + 4 and a few.
  EXPECT_LT(standing(simulation), 400u);
  EXPECT_GT(standing(simulation), 350u);
}

TEST_F(SegregationByHand, NoRobotStopsOnGroundOfNoOrOfTheWrongColour) {
  for (const auto& [grey, controller] : {std::pair("0.5", ""), std::pair("0", R"(, "informed": "white")"),
                                         std::pair("1", R"(, "informed": "black")")}) {
    Simulation simulation = crowd("9", grey, controller, 0.1);
    simulation.run_for(2);
    EXPECT_EQ(standing(simulation), 0u) << grey << controller;
  }
  Simulation simulation = crowd("9", "1", R"(, "informed": "white", "leave_per_s": 0)", 0.1);
  simulation.run_for(2);
  EXPECT_EQ(standing(simulation), 9u);
}

// ---- harvest.json

/// Pucks a minute that a group brings home, mean over four seeds: with fewer, the mean depends much on the
/// seeds.
constexpr int k_seeds_of_harvest = 4;
double harvest(const char* robots) {
  double sum = 0;
  for (int seed = 1; seed <= k_seeds_of_harvest; ++seed) {
    Simulation simulation =
        scene("harvest.json", static_cast<std::uint64_t>(seed), {{"/populations/1/count", robots}});
    simulation.run_for(7200);
    EXPECT_TRUE(simulation.stopped()) << robots << " robots, seed " << seed << ": 48 pucks are home";
    sum += 60 * 48 / simulation.time_s();
  }
  return sum / k_seeds_of_harvest;
}

TEST(HarvestScene, RobotsHinderOneAnother) {
  if (test::k_slow_build) GTEST_SKIP() << "takes some 120,000 ticks";
  const double one = harvest("1"), eight = harvest("8"), many = harvest("32");
  EXPECT_LT(one, 1.7) << "what one brings that need not search: 7.6 m at 0.3 m/s, and 10 s for the rest";
  EXPECT_GT(eight, 4 * one);
  EXPECT_LT(eight / 8, 0.8 * one) << "each brings less than alone";
  EXPECT_LT(many / 32, 0.2 * one);
  EXPECT_LT(many, 0.5 * eight) << "past the best size the group brings less";
}

TEST(HarvestScene, NoPuckIsLost) {
  Simulation simulation = scene("harvest.json", 1);
  Measures measures(simulation);
  simulation.run_for(test::k_slow_build ? 5 : 60);
  const engine::World& world = simulation.world();
  std::size_t there = 0;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    there +=
        world.view().is_there(Row(r)) && world.spec().name(world.view().body(Row(r))).starts_with("puck");
  EXPECT_EQ(static_cast<double>(there), 60 - measures.value("delivered"));
  if (test::k_slow_build) return;
  EXPECT_GT(measures.value("delivered"), 5);
}

}  // namespace
}  // namespace troupe::scenes_test
