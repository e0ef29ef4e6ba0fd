// worlds/gradient.json, flock.json, perception.json and chatter.json: swarms that communicate by radio.

#include "engine/world/world.hpp"
#include "models/controllers/gradient.hpp"
#include "sensors/radio.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::radio_scenes_test {
namespace {

std::filesystem::path shipped(const char* name) { return test::source_dir() / "worlds" / name; }

/// A number that the controller of this kind keeps for a body.
template <class T>
T memory_of(const engine::World& world, BodyId body, std::string_view table_name,
            std::string_view field_name) {
  for (const engine::StateTable& table : world.tables()) {
    if (table.component() != table_name) continue;
    const auto row = std::ranges::find(table.ids(), body);
    if (row == table.ids().end()) continue;
    for (std::size_t f = 0; f < table.fields().size(); ++f)
      if (table.fields()[f].name == field_name)
        return table.cell<T>(static_cast<std::size_t>(row - table.ids().begin()), f)[0];
  }
  throw std::out_of_range(std::string(field_name));
}

// ---- gradient.json

struct Station {
  Vec2 place;
  std::uint32_t hops;
};

/// Whether the straight line crosses one of the two walls, by geometry of its own.
bool is_hidden(const Vec2& p, const Vec2& q) {
  const auto turn = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  // worlds/gradient.json: 5 m x 0.1 m, upright.
  for (const auto& [x, y] : {std::pair(-1.6, -1.0), std::pair(1.8, 1.0)}) {
    const std::array<Vec2, 4> corners{Vec2(x - 0.05, y - 2.5), Vec2(x + 0.05, y - 2.5),
                                      Vec2(x + 0.05, y + 2.5), Vec2(x - 0.05, y + 2.5)};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec2& a = corners[i];
      const Vec2& b = corners[(i + 1) % 4];
      if (turn(p, q, a) * turn(p, q, b) < 0 && turn(a, b, p) * turn(a, b, q) < 0) return true;
    }
  }
  return false;
}

/// Hops from station 0 to each, breadth first, over all links; none: unknown.
std::vector<std::uint32_t> hops_by_search(const std::vector<Station>& stations) {
  std::vector<std::uint32_t> hops(stations.size(), models::k_hops_unknown);
  std::vector<std::size_t> frontier{0};
  hops[0] = 0;
  while (!frontier.empty()) {
    std::vector<std::size_t> next;
    for (const std::size_t i : frontier)
      for (std::size_t j = 0; j < stations.size(); ++j) {
        if (hops[j] != models::k_hops_unknown || (stations[i].place - stations[j].place).norm() > 2 ||
            is_hidden(stations[i].place, stations[j].place))
          continue;
        hops[j] = hops[i] + 1;
        next.push_back(j);
      }
    frontier = std::move(next);
  }
  return hops;
}

TEST(GradientScene, HopsAreThoseOfASearchAlongTheLinks) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 6,000 ticks";
  Simulation simulation(shipped("gradient.json"), {.threads = 2});
  const engine::World& world = simulation.world();
  simulation.run_for(600);
  std::vector<Station> stations{{world.view().pose(world.state().names.find("beacon")).position(), 0}};
  std::size_t roaming = 0;
  for (const std::string& name : simulation.robot_names()) {
    const BodyId body = world.state().names.find(name);
    if (memory_of<std::uint8_t>(world, body, "gradient/0", "settled") == 0) {
      ++roaming;
      continue;
    }
    stations.push_back(
        {world.view().pose(body).position(), memory_of<std::uint32_t>(world, body, "gradient/0", "hops")});
  }
  const std::vector<std::uint32_t> expected = hops_by_search(stations);
  std::uint32_t most = 0;
  double farthest_behind = 0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    EXPECT_EQ(stations[i].hops, expected[i]) << i << " at " << stations[i].place.transpose();
    most = std::max(most, stations[i].hops);
    // Who stands just behind the first wall is one or two radio ranges away, and many more hops.
    const Vec2 way = stations[i].place - stations[0].place;
    if (stations[i].place.x() > -1.5 && way.norm() < 2.5)
      farthest_behind = std::max<double>(farthest_behind, stations[i].hops);
  }
  EXPECT_GE(stations.size(), 28u);
  EXPECT_LE(roaming, 18u);
  EXPECT_GE(farthest_behind, 5);
  EXPECT_GE(most, 9u) << "the way round both walls is 16 m";
}

// ---- flock.json

double order(const Simulation& simulation) {
  Vec2 sum(0, 0);
  const engine::World& world = simulation.world();
  for (const Pose& pose : world.view().poses()) sum += Vec2(std::cos(pose.heading), std::sin(pose.heading));
  return sum.norm() / static_cast<double>(world.view().poses().size());
}

TEST(FlockScene, RobotsComeToAgreeWhateverTheSeed) {
  const std::uint64_t seeds = test::k_slow_build ? 1 : test::scene_seeds();
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SimulationOptions options;
    options.threads = 2;
    options.seed = seed;
    Simulation simulation(shipped("flock.json"), options);
    EXPECT_LT(order(simulation), 0.35) << "seed " << seed;
    simulation.run_for(test::k_slow_build ? 5 : 60);
    EXPECT_GT(order(simulation), test::k_slow_build ? 0.4 : 0.9) << "seed " << seed;
  }
}

// ---- perception.json

TEST(PerceptionScene, TheSwarmFindsThatMoreOfTheFloorIsWhite) {
  if (test::k_slow_build) GTEST_SKIP() << "takes 40,000 ticks";
  int agreed = 0;
  std::uint64_t last_divided = 0;  // last tick with two opinions, seed 1
  for (std::uint64_t seed = 1; seed <= test::scene_seeds(); ++seed) {
    SimulationOptions options;
    options.threads = 2;
    options.seed = seed;
    Simulation simulation(shipped("perception.json"), options);
    const engine::World& world = simulation.world();
    simulation.step();
    const auto white = [&] {
      int count = 0;
      for (const std::string& name : simulation.robot_names())
        count += memory_of<std::uint8_t>(world, world.state().names.find(name), "collective_perception/0",
                                         "opinion");
      return count;
    };
    EXPECT_EQ(white(), 10) << "as many begin for white as for black";
    if (seed == 1)
      simulation.on_tick([&](Simulation& now) { last_divided = white() < 20 ? now.tick() : last_divided; });
    simulation.run_for(400);
    agreed += white() >= 18;
  }
  EXPECT_GE(agreed + 1, static_cast<int>(test::scene_seeds())) << "of all seeds but one";
  EXPECT_EQ(last_divided, 1297) << "docs/ground.md";
}

// ---- chatter.json

TEST(ChatterScene, MessagesGoAndGetLostInEveryWay) {
  Simulation simulation(shipped("chatter.json"), {.threads = 2});
  simulation.run_for(test::k_slow_build ? 1 : 10);
  std::uint64_t heard = 0;
  std::uint64_t lost = 0;
  std::uint64_t dropped = 0;
  for (const engine::StateTable& table : simulation.world().tables()) {
    if (table.component() != "radio/radio") continue;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      heard += table.cell<std::uint32_t>(row, sensors::k_radio_count)[0];
      lost += table.cell<std::uint32_t>(row, sensors::k_radio_lost)[0];
      dropped += table.cell<std::uint32_t>(row, sensors::k_radio_dropped)[0];
    }
  }
  EXPECT_GT(heard, 1000u);
  EXPECT_GT(lost, 100u);
  EXPECT_GT(dropped, 100u);
}

TEST(ChatterScene, DependsOnNeitherThreadsNorTiles) {
  std::string first;
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(8u, 0.7), std::pair(2u, 20.0)}) {
    Simulation simulation(shipped("chatter.json"), {.threads = threads, .tile_size_m = tile_m});
    simulation.run_for(test::k_slow_build ? 1 : 20);
    if (first.empty()) first = simulation.hash_log_line();
    EXPECT_EQ(simulation.hash_log_line(), first) << threads << " threads";
  }
}

}  // namespace
}  // namespace troupe::radio_scenes_test
