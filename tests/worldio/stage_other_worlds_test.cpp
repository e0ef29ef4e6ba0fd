// Unusual constructs that worlds written for Stage may contain, and that Stage accepts.

#include "engine/kinds/sensor_params.hpp"
#include "tests/worldio/stage_fixture.hpp"
#include "troupe/registry.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace troupe::worldio::stage_other_worlds_test {
namespace {

using engine::get;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class StageOtherWorlds : public StageTest {
 protected:
  /// With all the kinds that there are.
  static const engine::Registry& registry() {
    static const engine::Registry all = make_registry();
    return all;
  }
  engine::WorldSpec load_all(std::string_view text) {
    return read(folder() / "w.world", std::string(text), {}, registry());
  }
  static const engine::Value& param(const engine::DeviceSpec& device, std::string_view name) {
    return get(registry().device(device.kind)->params, device.params, name);
  }
  static double fov_of_first(const engine::DeviceSpec& ranger) {
    return engine::from_record<engine::RangerParams>(ranger.params).transducers.at(0).fov;
  }
};

// Files.

TEST_F(StageOtherWorlds, DotsBehindALinkAreThoseOfTheSystem) {
  // "link/.." is the folder in which the linked one lies, not the one in which the link does.
  write("far/away/w.world", "");
  write("far/plan.inc", "model( name \"of far\" )\n");
  write("plan.inc", "model( name \"of here\" )\n");
  std::filesystem::create_directory_symlink(folder() / "far/away", folder() / "link");
  const auto spec = read(folder() / "link/w.world", "include \"../plan.inc\"\n", {}, registry());
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(name_of(spec, 1), "of far");
  const auto plain = read(folder() / "far/w.world", "include \"./../plan.inc\"\n", {}, registry());
  EXPECT_EQ(name_of(plain, 1), "of here");
}

TEST_F(StageOtherWorlds, WhatAnotherIncludeHasReadAlreadyIsNoNews) {
  write("robot.inc", "define robot position( size [0.1 0.1 0.1] )\n");
  write("swarm.inc", "include \"robot.inc\"\ndefine red robot( color \"red\" )\n");
  EXPECT_THAT(load("include \"robot.inc\"\ninclude \"swarm.inc\"\nred()\nrobot()").bodies, SizeIs(3));
  EXPECT_THAT(messages(), IsEmpty());
  write("other.inc", "\ndefine robot position( size [9 9 9] )\n");
  load("include \"robot.inc\"\ninclude \"other.inc\"\nrobot()");
  EXPECT_THAT(messages(), ElementsAre("other.inc:2: warning: macro \"robot\" is already defined at "
                                      "robot.inc:1; this later definition is ignored: remove it"));
}

// Names of macros and types.

TEST_F(StageOtherWorlds, AMacroMayTakeTheNameOfAPiece) {
  const auto spec = load(
      "define wedge model( size [1 1 1] block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [0 1] "
      ") )\n"
      "wedge()\n"
      "define block model( size [0.5 0.5 0.75] color \"red\" )\n"
      "block( pose [3 0 0 0] )\nmodel( block( pose [1 0 0 0] ) )\n");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_THAT(type_of(spec, 1).parts[0].solids[0].contours[0], SizeIs(3));
  EXPECT_EQ(type_of(spec, 2).parts[0].kind, "model");
  EXPECT_EQ(spec.bodies[2].pose_world_body.x, 3);
  EXPECT_THAT(part_names(type_of(spec, 3)), ElementsAre("", "model:0"));
}

TEST_F(StageOtherWorlds, TypesOfOlderVersionsAreCalledSo) {
  load("position( charger() )\n\npuck()\nmap()");
  const std::vector<std::string> found = messages();
  ASSERT_THAT(found, SizeIs(3));
  EXPECT_EQ(found[0],
            "w.world:1: error: \"charger\" is a model type of older versions of Stage: write model( "
            "give_watts 1000 "
            "joules -1 alwayson 1 )");
  EXPECT_EQ(found[1],
            "w.world:3: error: \"puck\" is a model type of older versions of Stage: write model( size [0.2 "
            "0.2 0.2] "
            "gripper_return 1 )");
  EXPECT_THAT(
      found[2],
      HasSubstr(
          "w.world:4: error: \"map\" is a model type of older versions of Stage: write model( bitmap "));
  // As macros, which is how worlds for 4.3 have them, they are like any other.
  load(
      "define map model( color \"black\" boundary 1 )\ndefine puck model( size [0.1 0.1 0.2] "
      ")\nmap()\npuck()");
  EXPECT_THAT(messages(), IsEmpty());
}

// Bodies and names of what is nested.

TEST_F(StageOtherWorlds, NamesBelowARenamedModelAndGlobalOnes) {
  const auto spec = load(
      "define arm model( name \"arm\" model( name \"/tip\" model() ) model() )\n"
      "position( name \"r0\" model( name \"mast\" arm() model( name \"flag\" ) ) )\n"
      "model( name \"/r1\" arm() )\n");
  EXPECT_THAT(part_names(type_of(spec, 1)),
              ElementsAre("", "mast", "mast.arm", "tip", "tip.model:0", "mast.arm.model:1", "mast.flag"));
  EXPECT_EQ(type_of(spec, 1).parts[3].alias, "mast.arm.model:0");
  EXPECT_EQ(name_of(spec, 2), "r1");
  EXPECT_THAT(part_names(type_of(spec, 2)), ElementsAre("", "arm", "tip", "tip.model:0", "arm.model:1"));
}

TEST_F(StageOtherWorlds, AChildStandsOnThePoseNotOnTheOriginOfItsParent) {
  // And its own origin moves its body and its sensor, not what stands on it.
  const auto spec = load(
      "position( size [1 1 0.5] origin [0.2 0 0.1 90]\n"
      "  ranger( pose [0.3 0 0 0] size [0.1 0.1 0.1] origin [0 0.4 0.05 90] stack_children 0\n"
      "    sensor( pose [0.01 0 0 0] size [0.02 0.02 0.02] )\n"
      "    model( size [0.1 0.1 0.1] ) ) )\n");
  const engine::TypeSpec& type = type_of(spec, 1);
  EXPECT_EQ(type.parts[1].pose_body_part, (Pose{0.3, 0, 0.5, 0}));
  EXPECT_EQ(type.parts[2].pose_body_part, (Pose{0.3, 0, 0.5, 0}));
  const Pose& eye = type.devices[0].pose_body_device;
  EXPECT_NEAR(eye.x, 0.3, 1e-15);
  EXPECT_NEAR(eye.y, 0.4, 1e-15);
  EXPECT_NEAR(eye.z, 0.55, 1e-15);
  EXPECT_NEAR(eye.heading, k_pi / 2, 1e-15);
}

TEST_F(StageOtherWorlds, ARangerWithABodyOfBlocksAndASensorAboveIt) {
  const auto spec = load(
      "position( size [0.44 0.38 0.22]\n"
      "  ranger( size [0.16 0.16 0.19] pose [0.05 0 0 0]\n"
      "    block( points 4 point[0] [0 0] point[1] [0 1] point[2] [1 1] point[3] [1 0] z [0 0.21] )\n"
      "    sensor( pose [0 0 0.1 0] range [0 8] fov 180 samples 180 ) ) )\n");
  EXPECT_THAT(messages(), IsEmpty());
  const engine::TypeSpec& robot = type_of(spec, 1);
  ASSERT_THAT(robot.parts[1].solids, SizeIs(1));
  EXPECT_NEAR(robot.parts[1].solids[0].z.min, 0.22, 1e-12);
  EXPECT_NEAR(robot.parts[1].solids[0].z.max, 0.41, 1e-12);  // stretched to its size
  EXPECT_TRUE(robot.parts[1].returns.obstacle);
}

TEST_F(StageOtherWorlds, SensorsOnSensorsOnGrippers) {
  const auto spec = load_all(
      "position( size [0.4 0.4 0.2]\n"
      "  gripper( pose [0.3 0 -0.2 0] fiducial( size [0 0 0] ) camera( ranger( sensor() blobfinder() ) ) ) "
      ")\n");
  EXPECT_THAT(messages(), IsEmpty());
  std::vector<std::string> kinds;
  for (const engine::DeviceSpec& device : type_of(spec, 1).devices) kinds.push_back(device.kind);
  EXPECT_THAT(kinds, ElementsAre("gripper", "fiducial", "camera", "ranger", "blobfinder"));
}

TEST_F(StageOtherWorlds, AnUnsizedBumperIsALargeBody) {
  const auto spec = load(
      "position( bumper( bcount 1 blength 0.1 ) )\nposition( bumper( bcount 1 blength 0.1 noblocks 1 ) )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: as in Stage, a bumper without \"size\" has a body of 0.4 m x "
                          "0.4 m x 1 m; give it a \"size\" (or \"noblocks 1\", if it should have no body)"));
  EXPECT_THAT(type_of(spec, 1).parts[1].solids, SizeIs(1));
  EXPECT_THAT(type_of(spec, 2).parts[1].solids, IsEmpty());
}

TEST_F(StageOtherWorlds, ALaserIsARangerAndItsSensor) {
  const auto spec = load_all(
      "position( laser( samples 9 noise [0.01 0 0] apply_range_min 1 intensity 1 alwayson 1 color \"blue\" ) "
      ")");
  EXPECT_THAT(messages(), IsEmpty());
  const engine::DeviceSpec& laser = type_of(spec, 1).devices[0];
  const auto params = engine::from_record<engine::RangerParams>(laser.params);
  EXPECT_DOUBLE_EQ(params.transducers.at(0).noise_stddev, 0.1);
  EXPECT_TRUE(params.transducers.at(0).apply_range_min);
  EXPECT_TRUE(params.intensity);
  EXPECT_EQ(type_of(spec, 1).parts[1].color, (Color{0, 0, 1, 1}));
}

// Values.

TEST_F(StageOtherWorlds, AWholeTurnMayBeWrittenWithFewDigits) {
  const auto degrees = load_all("position( ranger( sensor( fov 360 samples 360 ) ) fiducial( fov 360 ) )");
  EXPECT_NEAR(fov_of_first(type_of(degrees, 1).devices[0]), 2 * k_pi, 1e-12);
  EXPECT_NEAR(param(type_of(degrees, 1).devices[1], "fov").number(), 2 * k_pi, 1e-12);
  for (const char* turn : {"6.283185307", "6.28319", "6.2832"}) {
    const auto spec = load_all(fmt::format(
        "unit_angle \"radians\"\nposition( ranger( sensor( fov {0} ) ) fiducial( fov {0} ) )", turn));
    EXPECT_THAT(messages(), IsEmpty()) << turn;
    ASSERT_THAT(type_of(spec, 1).devices, SizeIs(2)) << turn;
    EXPECT_NEAR(fov_of_first(type_of(spec, 1).devices[0]), 2 * k_pi, 1e-9) << turn;
    EXPECT_NEAR(param(type_of(spec, 1).devices[1], "fov").number(), 2 * k_pi, 1e-9) << turn;
  }
  const auto panned = load_all("unit_angle \"radians\"\nposition( blobfinder( pan -6.2832 ) )");
  EXPECT_THAT(messages(), IsEmpty());
  ASSERT_THAT(type_of(panned, 1).devices, SizeIs(1));
  EXPECT_EQ(param(type_of(panned, 1).devices[0], "pan").number(), -2 * k_pi);
  load_all("unit_angle \"radians\"\nranger( sensor( fov 6.3 samples 2 ) )");
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("w.world:2: error: \"fov\" must be at most 6.28")));
}

TEST_F(StageOtherWorlds, OddIntervalsAndManyControllers) {
  const auto spec = load(
      "interval_sim 33.3\n"
      "position( update_interval 1 ranger( update_interval 33.3 sensor( samples 9 ) )\n"
      "  ranger( sensor() ) ctrl [ \"wander\" \"expand\" ] )\n");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(spec.tick_s, 0.0333);
  EXPECT_EQ(type_of(spec, 1).drive->period_s, 0.001);  // every tick
  EXPECT_THAT(type_of(spec, 1).controllers, SizeIs(2));
}

TEST_F(StageOtherWorlds, TurnRatesBeyondHalfATurnDoNotWrap) {
  const auto spec = load("position( velocity_bounds [-2 2 0 0 0 0 -400 400] )");
  const engine::FieldTable& table = test_registry().drive("diff")->params;
  EXPECT_NEAR(get(table, type_of(spec, 1).drive->params, "turn_max").number(), 400 * k_pi / 180, 1e-12);
  EXPECT_NEAR(get(table, type_of(spec, 1).drive->params, "turn_min").number(), -400 * k_pi / 180, 1e-12);
}

TEST_F(StageOtherWorlds, CamerasAreAsLargeAsScreens) {
  const auto spec = load_all("position( camera( resolution [1280 720] ) )");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(param(type_of(spec, 1).devices[0], "width").integer(), 1280);
  load_all("position( camera( resolution [5000 10] ) )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: \"resolution\" must be at most 4096, found 5000"));
}

}  // namespace
}  // namespace troupe::worldio::stage_other_worlds_test
