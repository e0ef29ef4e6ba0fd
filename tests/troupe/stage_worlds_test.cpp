// Stage's own worlds, unmodified: they load, they run, and in its hospital the swarm spreads as it does in
// Stage.

#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>

namespace troupe {
namespace {

namespace fs = std::filesystem;

const fs::path k_stage_worlds = fs::path(TROUPE_SOURCE_DIR) / ".." / "shared" / "stage-worlds";

#define SKIP_WITHOUT_STAGE_WORLDS() \
  if (!fs::exists(k_stage_worlds)) GTEST_SKIP() << "Stage's worlds are not at " << k_stage_worlds.string()

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

}  // namespace
}  // namespace troupe
