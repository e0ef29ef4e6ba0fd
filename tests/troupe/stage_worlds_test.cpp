// The worlds of Stage, unmodified: they load and run, and in the hospital the swarm disperses as in Stage. If
// the files are missing, stage_styles_test.cpp and a swarm with a computed dispersion replace them.

#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>

namespace troupe::stage_worlds_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_stage_worlds = test::source_dir() / ".." / "shared" / "stage-worlds";

#define SKIP_WITHOUT_STAGE_WORLDS() \
  if (!fs::exists(k_stage_worlds)) GTEST_SKIP() << "Stage's data are not in " << k_stage_worlds.string()

struct StageWorld {
  const char* file;
  std::size_t robots;
  bool drives_itself;  ///< has a controller that we ship

  friend std::ostream& operator<<(std::ostream& out, const StageWorld& world) { return out << world.file; }
};

class StageWorlds : public ::testing::TestWithParam<StageWorld> {};

TEST_P(StageWorlds, LoadsAndRuns) {
  SKIP_WITHOUT_STAGE_WORLDS();
  const StageWorld& world = GetParam();
  Simulation simulation(k_stage_worlds / world.file);
  EXPECT_EQ(simulation.robots(), world.robots);
  simulation.run_for(test::k_slow_build ? 0.5 : 5);
  const Statistics s = simulation.statistics();
  EXPECT_EQ(s.held_at_bounds, 0u);
  EXPECT_TRUE(std::isfinite(s.mean_displacement_m));
  EXPECT_EQ(s.mean_displacement_m > 0, world.drives_itself) << s.mean_displacement_m;
}

INSTANTIATE_TEST_SUITE_P(Unmodified, StageWorlds,
                         ::testing::Values(StageWorld{"benchmark/hospital.world", 1000, true},
                                           StageWorld{"benchmark/cave.world", 100, true},
                                           StageWorld{"simple.world", 2, true},
                                           StageWorld{"pioneer_walle.world", 2, true},
                                           StageWorld{"roomba.world", 1, false},
                                           StageWorld{"sensor_noise_demo.world", 1, false}),
                         [](const auto& world) {
                           std::string name = fs::path(world.param.file).stem();
                           std::erase(name, '_');
                           return name;
                         });

TEST(StageHospital, TheSwarmSpreadsAsInStage) {
  SKIP_WITHOUT_STAGE_WORLDS();
  Simulation simulation(k_stage_worlds / "benchmark" / "hospital.world");
  // Stage 4.3's own mean displacement.
  struct Point {
    double time_s;
    double displacement_m;
  };
  for (const auto& [time_s, displacement_m] : {Point{10, 0.51}, Point{30, 1.30}, Point{60, 2.07}}) {
    simulation.run_for(time_s - simulation.time_s());
    EXPECT_NEAR(simulation.statistics().mean_displacement_m, displacement_m, 0.2 * displacement_m)
        << time_s << " s";
    if (test::k_slow_build) break;
  }
}

// tests/stage_like/readings.py works out each robot's way by other means: readings, Stage's rule, motion.
// After seconds a last bit of a beam may have turned a robot elsewhere, so then only their mean counts.
TEST(StageLikeSwarm, SpreadsAsWasWorkedOut) {
  const fs::path folder = test::source_dir() / "tests/stage_like";
  Simulation simulation(folder / "swarm.world");
  std::ifstream lines(folder / "swarm.jsonl");
  std::size_t read = 0;
  for (std::string line; std::getline(lines, line); ++read) {
    const nlohmann::json expected = nlohmann::json::parse(line);
    const double time_s = expected.at("t");
    simulation.run_for(time_s - simulation.time_s());
    const double displacement_m = expected.at("displacement");
    EXPECT_NEAR(simulation.statistics().mean_displacement_m, displacement_m, 0.01 * displacement_m)
        << time_s << " s";
    if (time_s > 3) continue;
    ASSERT_EQ(expected.at("poses").size(), simulation.robots());
    for (std::size_t r = 0; r < simulation.robots(); ++r) {
      const Pose pose = simulation.find("r" + std::to_string(r)).pose();
      const auto& [x, y, heading] = expected.at("poses")[r].get<std::array<double, 3>>();
      EXPECT_NEAR(pose.x, x, 1e-5) << "r" << r << " at " << time_s << " s";
      EXPECT_NEAR(pose.y, y, 1e-5) << "r" << r << " at " << time_s << " s";
      EXPECT_NEAR(std::remainder(pose.heading - heading, 2 * k_pi), 0, 1e-4)
          << "r" << r << " at " << time_s << " s";
    }
  }
  EXPECT_EQ(read, 4u);
  EXPECT_EQ(simulation.statistics().stalled, 0u);
}

}  // namespace
}  // namespace troupe::stage_worlds_test
