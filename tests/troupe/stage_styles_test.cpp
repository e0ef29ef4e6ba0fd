// Worlds in the styles of the worlds of Stage, written for these tests. They load with the expected warnings
// only, run, and give the same bits with any number of threads.

#include "base/diagnostics.hpp"
#include "engine/kinds/sensor_params.hpp"
#include "engine/world/world.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace troupe::stage_styles_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path k_styles = test::source_dir() / "tests/troupe/stage_styles";

struct Style {
  const char* file;
  std::size_t bodies;                      ///< the ground left out
  std::size_t robots;                      ///< of them those that have a drive
  std::size_t devices;                     ///< of the first robot
  bool moves = false;                      ///< it has controllers that drive
  std::vector<std::string> warnings = {};  ///< the beginnings of all, from the file's name on

  friend std::ostream& operator<<(std::ostream& out, const Style& style) { return out << style.file; }
};

class StageStyles : public ::testing::TestWithParam<Style> {};

/// Without the folder before it.
std::string shortened(std::string line) {
  const std::string folder = k_styles.string() + "/";
  for (std::size_t at; (at = line.find(folder)) != std::string::npos;) line.erase(at, folder.size());
  return line;
}

TEST_P(StageStyles, LoadsWithItsWarningsAndRuns) {
  const Style& style = GetParam();
  Simulation simulation(k_styles / style.file, {.threads = 1});
  const engine::World& world = simulation.world();
  EXPECT_EQ(world.spec().bodies.size(), style.bodies + 1);
  ASSERT_EQ(simulation.robots(), style.robots);
  if (style.robots > 0) {
    const BodyId first = world.state().names.find(simulation.robot_names().front());
    EXPECT_EQ(world.view().type(world.view().row(first)).devices.size(), style.devices);
  }
  std::vector<std::string> warnings;
  for (const std::string& warning : simulation.warnings()) warnings.push_back(shortened(warning));
  EXPECT_EQ(warnings.size(), style.warnings.size()) << ::testing::PrintToString(warnings);
  for (std::size_t i = 0; i < std::min(warnings.size(), style.warnings.size()); ++i)
    EXPECT_THAT(warnings[i], ::testing::StartsWith(style.warnings[i]));

  const double seconds = test::k_slow_build ? 0.3 : 3;
  simulation.run_for(seconds);
  const Statistics statistics = simulation.statistics();
  EXPECT_EQ(statistics.held_at_bounds, 0u);
  EXPECT_TRUE(std::isfinite(statistics.mean_displacement_m));
  if (!style.moves) {
    EXPECT_EQ(statistics.mean_displacement_m, 0);
  } else if (!test::k_slow_build) {  // some wait at first
    EXPECT_GT(statistics.mean_displacement_m, 0);
  }
  Simulation again(k_styles / style.file, {.threads = 2, .tile_size_m = 1.3});
  again.run_for(seconds);
  EXPECT_EQ(again.hash_log_line(), simulation.hash_log_line());
}

std::vector<Style> styles() {
  return {
      {"demo.world",
       3,
       2,
       2,
       true,
       {"demo.world:10: warning: properties without effect (docs/stage-worlds.md says why): threads",
        "demo.world:7: warning: properties without effect on the run, because only Stage's window uses them: "
        "paused, "
        "show_flags of a window, gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor, "
        "trail_length"}},
      {"follow.world",
       2,
       1,
       2,
       true,
       {"inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"blocks.world",
       3,
       2,
       2,
       true,
       {"inc/figure.inc:6: warning: old syntax: \"laser_return\" is ignored, as in Stage: write "
        "ranger_return 1",
        "inc/figure.inc:7: warning: old syntax: \"blobfinder_return\" is ignored, as in Stage: write "
        "blob_return 1",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"noise.world",
       2,
       1,
       1,
       false,
       {"inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline"}},
      {"disc.world",
       2,
       1,
       1,
       false,
       {"inc/discs.inc:27: warning: \"size\" takes 3 values [x y z], found 4; the further values are ignored",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline"}},
      {"camera.world",
       2,
       1,
       1,
       false,
       {"camera.world:11: warning: \"watts\" of a model of type camera has no effect: Troupe computes the "
        "power of such a model (docs/stage-worlds.md): remove this property",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline"}},
      {"arms.world",
       5,
       3,
       4,
       true,
       {"arms.world:13: warning: the name \"puck\" is already used by the model at line 12: a search for "
        "this name finds only the "
        "last model that has it"}},
      {"layers.world",
       3,
       1,
       3,
       false,
       {"layers.world:10: warning: macro \"late_base\" is already defined at line 4; this later definition "
        "is ignored: remove it"}},
      {"everything.world",
       11,
       7,
       5,
       true,
       {"inc/discs.inc:27: warning: \"size\" takes 3 values [x y z], found 4; the further values are ignored",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window "
        "uses them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"odometry.world",
       4,
       3,
       5,
       false,
       {"odometry.world:7: warning: old syntax: \"interval_real\" is ignored, as in Stage: write speedup 1, ",
        "odometry.world:21: warning: old syntax: \"channel_count\" and \"channels\" are ignored, as in "
        "Stage: write "
        "colors_count 2 colors [\"red\" \"green\"]",
        "inc/beacons.inc:6: warning: old syntax: \"width\" and \"height\" are ignored, as in Stage: write "
        "resolution "
        "[80 60], ",
        "inc/beacons.inc:6: warning: old syntax: \"horizfov\" is ignored, as in Stage: write fov [70 40], ",
        "inc/beacons.inc:6: warning: old syntax: \"size3\" is ignored, as in Stage: write size [x y z]",
        "inc/carts.inc:149: warning: old syntax: the three values of \"origin\" are read as [x y heading]; "
        "write [x y z heading]",
        "inc/carts.inc:150: warning: old syntax: the three values of \"pose\" are read as [x y heading]; "
        "write [x y z heading] (and 2 more such warnings)",
        "inc/carts.inc:145: warning: old syntax: the two values of \"size\" are read as [x y], with a "
        "height of 0.02 m; write [x y z]",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor",
        "odometry.world:8: warning: obsolete properties, ignored as in Stage: remove them: gui_disable"}},
      {"lab.world",
       11,
       1,
       3,
       true,
       {"inc/beacons.inc:2: warning: old syntax: \"laser_return\" is ignored, as in Stage: write "
        "ranger_return 1",
        "inc/beacons.inc:2: warning: old syntax: the two values of \"size\" are read as [x y], with a height "
        "of 1 m; write [x y z] (and 1 more such warning)",
        "lab.world:12: warning: old syntax: the three values of \"pose\" are read as [x y heading]; "
        "write [x y z heading]",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"charging.world",
       10,
       6,
       6,
       true,
       {"inc/discs.inc:43: warning: \"watts\" of a model of type position has no effect: Troupe computes the "
        "power of such a model (docs/stage-worlds.md): remove this property",
        "inc/discs.inc:27: warning: \"size\" takes 3 values [x y z], found 4; the further values are ignored",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline"}},
      {"forage.world",
       9,
       4,
       5,
       true,
       {"inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"forage2.world",
       9,
       3,
       3,
       true,
       {"inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"flock.world",
       17,
       16,
       2,
       true,
       {"flock.world:7: warning: properties without effect (docs/stage-worlds.md says why): threads",
        "inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"city.world",
       4,
       3,
       2,
       true,
       {"inc/plan.inc:5: warning: properties without effect on the run, because only Stage's window uses "
        "them: "
        "gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"}},
      {"units.world", 2, 1, 1, true},
      {"old_swarm.world",
       10,
       10,
       0,
       false,
       {"old_swarm.world:4: warning: old syntax: \"gui_interval\" is ignored, as in Stage: write window( "
        "interval 40 )",
        "old_swarm.world:8: warning: old syntax: \"polygons\", \"polygon[k].points\" and "
        "\"polygon[k].point[k]\" are "
        "ignored, as in Stage: write a block( ",
        "old_swarm.world:14: warning: old syntax: \"scount\", \"spose[k]\", \"ssize\" and \"sview\" are "
        "ignored, as in "
        "Stage: write sensor( pose [0 0 0 0] range [0 2] fov 15 ) for the first transducer",
        "old_swarm.world:7: warning: old syntax: the two values of \"size\" are read as [x y], with a "
        "height of 1 m; write [x y z]",
        "old_swarm.world:14: warning: a ranger without a sensor( ... ) measures nothing: add a sensor( ... )",
        "old_swarm.world:16: warning: old syntax: the three values of \"pose\" are read as [x y heading]; "
        "write [x y z heading] (and 9 more such warnings)",
        "old_swarm.world:3: warning: obsolete properties, ignored as in Stage: remove them: size"}}};
}

INSTANTIATE_TEST_SUITE_P(Styles, StageStyles, ::testing::ValuesIn(styles()), [](const auto& style) {
  std::string name = fs::path(style.param.file).stem();
  std::erase(name, '_');
  return name;
});

TEST(StageStylesLayers, LaterLayersWinAndChildrenAddUp) {
  const Simulation simulation(k_styles / "layers.world", {.threads = 1});
  const engine::World& world = simulation.world();
  const engine::WorldSpec& spec = world.spec();
  ASSERT_EQ(spec.bodies.size(), 4u);
  EXPECT_EQ(spec.bodies[1].color, (Color{0, 1, 0, 1}));
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{2, 2, 0, 0}));
  std::vector<std::string> devices;
  for (const engine::DeviceSpec& device : spec.type(BodyId(1)).devices)
    devices.push_back(
        device.name + " " +
        std::to_string(engine::from_record<engine::RangerParams>(device.params).transducers.size()));
  EXPECT_THAT(devices, ::testing::ElementsAre("one 2", "two 3", "three 2"));
  std::vector<std::string> parts;
  for (const engine::PartSpec& part : spec.type(BodyId(2)).parts) parts.push_back(part.name);
  EXPECT_THAT(parts, ::testing::ElementsAre("", "kid", "model:1"));
  EXPECT_EQ(spec.type(BodyId(2)).parts[0].size.x(), 0.3) << "the first definition";
  EXPECT_NEAR(spec.bodies[world.state().names.find("5").index()].pose_world_body.heading, radians(40), 1e-12);
}

/// What loading it says.
std::string refusal(const char* file) {
  try {
    const Simulation simulation(k_styles / file, {.threads = 1});
  } catch (const InputError& error) {
    return shortened(error.what());
  }
  return "it loads";
}

// What Stage 4.3 does not load either, it leaves with a number, or hangs over; here each place is told.

TEST(StageStylesRefused, MapsOfOlderVersions) {
  const std::string text = refusal("wifi.world");
  EXPECT_THAT(
      text,
      HasSubstr("wifi.world:8: error: \"map\" is a model type of older versions of Stage: write model( "));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("wifi.world:9: error"))) << "radios are here again";
}

TEST(StageStylesRefused, IncludesThatAreNotWhereTheyAreSaidToBe) {
  const std::string text = refusal("lost.world");
  EXPECT_THAT(text, HasSubstr("lost.world:1: error: cannot read the included file "));
  EXPECT_THAT(
      text,
      HasSubstr(
          "tests/troupe/pioneer.inc: there is no such file; it comes with Stage: "));  // beside the folder,
                                                                                       // where it is said to
                                                                                       // be
  EXPECT_THAT(text, HasSubstr("lost.world:2: error: cannot read the included file wifi/map.inc"));
}

TEST(StageStylesRefused, ControllersThatNoRobotHas) {
  EXPECT_THAT(refusal("no_plugin.world"),
              HasSubstr("no_plugin.world:4: error: unknown controller \"fasr_plan\"; known: "));
}

}  // namespace
}  // namespace troupe::stage_styles_test
