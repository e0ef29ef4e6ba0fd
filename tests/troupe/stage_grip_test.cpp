#include "engine/world/world.hpp"
#include "models/devices/actuator.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/simulation.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

namespace troupe::stage_grip_test {
namespace {

using models::ActuatorState;
using models::GripperState;
using ::testing::HasSubstr;

/// Grippers and actuators of .world files.
class StageGrip : public test::ScratchTest {
 protected:
  Simulation load(std::string_view text) {
    return Simulation(write("w.world", text), SimulationOptions{.threads = 1});
  }
  /// The device of a body that is called so.
  static const engine::BodyType::Device& device(const engine::World& world, Row row, std::string_view name) {
    for (const engine::BodyType::Device& device : world.view().type(row).devices)
      if (device.name == name) return device;
    throw std::runtime_error("no such device");
  }
  template <class State>
  static const State& state(const Simulation& simulation, std::string_view body, std::string_view name) {
    const engine::World& world = simulation.world();
    const Row row = world.view().row(world.state().names.find(body));
    return world.tables()[(device(world, row, name)).table].template as<State>(world.view().slot(row));
  }
  static void step(Simulation& simulation, int ticks) {
    for (int t = 0; t < ticks; ++t) simulation.step();
  }
};

TEST_F(StageGrip, AnActuatorsLimitsStandInTheirOrder) {
  EXPECT_THAT(
      test::message_of<InputError>([&] { load("\nposition( actuator( name \"lift\" min_position 2 ) )"); }),
      ::testing::EndsWith("w.world:2: error: device \"lift\" has a \"min_position\" of 2, "
                          "above its \"max_position\" of 1"));
}

TEST_F(StageGrip, TheGripperIsABaseAndTwoPaddlesThatMove) {
  Simulation simulation = load(
      "position( name \"r\" gripper( alwayson 1 size [2 4 1] paddle_size [0.5 0.25 0.5] "
      "paddle_state [\"closed\" \"up\"] ) )");
  const auto& parts = simulation.world().spec().types.back().parts;
  ASSERT_EQ(parts.size(), 4u);
  EXPECT_EQ(bounds(parts[1].solids[0].contours[0]).max, Vec2(0, 2)) << "the base";
  EXPECT_EQ(bounds(parts[2].solids[0].contours[0]).min, Vec2(0, 1)) << "the left paddle, open";
  EXPECT_EQ(bounds(parts[3].solids[0].contours[0]).max, Vec2(1, -1)) << "the right one";
  EXPECT_EQ(parts[2].solids[0].z, (ZInterval{1, 1.5})) << "on the robot, and down";

  const auto& gripper = state<GripperState>(simulation, "r", "gripper:0");
  EXPECT_EQ(gripper.paddles, GripperState::closed);
  EXPECT_EQ(gripper.lift, GripperState::is_up);
  const engine::World& world = simulation.world();
  const Row row = world.view().row(world.state().names.find("r"));
  EXPECT_EQ(world.state().joint_state(row, 0), (Pose{0, -1, 0.5, 0}))
      << "left: a metre to the middle, half one up";
  EXPECT_EQ(world.state().joint_state(row, 1), (Pose{0, 1, 0.5, 0}));
  const std::string error = test::message_of<InputError>(
      [&] { load("position( gripper( paddle_size [1 2 3] ) gripper( paddle_state [\"shut\" \"up\"] ) )"); });
  EXPECT_THAT(error, HasSubstr("w.world:1: error: \"paddle_size\" needs three fractions of the "
                               "gripper's size, [x y z], each above 0 and below 1, with y below 0.5"));
  EXPECT_THAT(
      error,
      HasSubstr("\"paddle_state\" needs two strings: \"open\" or \"closed\", then \"up\" or \"down\""));
}

// The gripper reaches from 0.2 to 0.4 m before the robot's origin; the puck stands between its paddles.
TEST_F(StageGrip, AutosnatchClosesOnWhatBreaksABeam) {
  constexpr std::string_view k_turning_world =
      "define puck model( size [0.1 0.1 0.1] pose [0.34 0 0 0] gripper_return 1 )\n"
      "position( name \"r\" size [0.4 0.4 0.3] stack_children 0\n"
      "  gripper( pose [0.3 0 0 0] alwayson 1 autosnatch 1 ) )\n"
      "puck( name \"o\" )\n";
  Simulation simulation = load(k_turning_world);
  step(simulation, 30);
  const engine::World& world = simulation.world();
  EXPECT_EQ(world.view().carrier(world.view().row(world.state().names.find("o"))),
            world.state().names.find("r"));
  EXPECT_EQ(state<GripperState>(simulation, "r", "gripper:0").held, world.state().names.find("o").value + 1);

  std::string smooth(k_turning_world);
  smooth.replace(smooth.find("gripper_return 1"), 16, "gripper_return 0");
  Simulation unfelt = load(smooth);
  step(unfelt, 30);
  EXPECT_EQ(state<GripperState>(unfelt, "r", "gripper:0").paddle_position, 0);
}

TEST_F(StageGrip, ActuatorsMoveWhatStandsOnThem) {
  Simulation simulation = load(
      "position( name \"r\" size [0.4 0.4 0.2] ctrl \"operate arm:go_to:9@0.1,arm:go_to:-9@4\"\n"
      "  actuator( name \"arm\" size [0.1 0.1 0.1] alwayson 1 type \"linear\" axis [1 0 1]\n"
      "    min_position -1 max_position 2 max_speed 0.5 start_position 0.5\n"
      "    model( name \"hand\" size [0.1 0.1 0.1] ) )\n"
      "  actuator( name \"table\" type \"rotational\" size [0.05 0.05 0.05] pose [-0.1 0 0 0] start_position "
      "0.7\n"
      "    model( name \"top\" size [0.02 0.02 0.02] pose [0 0.01 0 0] ) ) )\n");
  const engine::World& world = simulation.world();
  const Row row = world.view().row(world.state().names.find("r"));
  const double along = 0.5 / sqrt(2.0);
  EXPECT_NEAR(world.state().joint_state(row, 0).x, along, 1e-12);
  EXPECT_NEAR(world.state().joint_state(row, 0).z, along, 1e-12);
  EXPECT_EQ(state<ActuatorState>(simulation, "r", "arm").position, 0.5);
  // The outline of what stands on the arm is moved; that of the robot is not.
  EXPECT_NEAR(world.view().outline(row)[0].x(), -0.2, 1e-12);
  EXPECT_NEAR(world.view().outline(row)[8].x(), -0.05 + along, 1e-12);
  EXPECT_NEAR(world.view().lift(row, world.view().type(row).outlines[2].joint), along, 1e-12);
  EXPECT_NEAR(simulation.find("r.arm.hand").pose().x, along, 1e-12);
  EXPECT_NEAR(simulation.find("r.arm.hand").pose().z, 0.2 + 0.1 + along, 1e-12);
  const Pose top = simulation.find("r.table.top").pose();
  EXPECT_NEAR(top.heading, 0.7, 1e-12);
  EXPECT_NEAR(top.x, -0.1 - 0.01 * std::sin(0.7), 1e-12);
  EXPECT_NEAR(top.y, 0.01 * std::cos(0.7), 1e-12);

  const auto position = [&] { return state<ActuatorState>(simulation, "r", "arm").position; };
  step(simulation, 5);  // it is told in the first tick, and moves from the second on
  EXPECT_NEAR(position(), 0.5 + 4 * 0.05, 1e-12);
  step(simulation, 30);
  EXPECT_EQ(position(), 2);
  step(simulation, 70);
  EXPECT_EQ(position(), -1);
}

// Both drive 0.05 m a tick from the second on, the rider to the left of its carrier. Its side may not pass
// the wall's face, at y = 1.13 m: after 20 motions it stands at 1 m.
TEST_F(StageGrip, APositionInsideAnotherDrivesInItsFrame) {
  Simulation simulation = load(
      "position( name \"carrier\" size [1 1 0.2] ctrl \"script line\"\n"
      "  position( name \"rider\" size [0.2 0.2 0.2] pose [0 0 0 90] ctrl \"script line\"\n"
      "    ranger( alwayson 1 sensor( range [0 8] fov 0 samples 1 ) ) ) )\n"
      "model( name \"wall\" pose [0 1.23 0 0] size [20 0.2 1] )\n");
  Model rider = simulation.find("carrier.rider");
  step(simulation, 11);
  EXPECT_NEAR(simulation.find("carrier").pose().x, 0.5, 1e-12);
  EXPECT_NEAR(rider.pose().x, 0.5, 1e-12);
  EXPECT_NEAR(rider.pose().y, 0.5, 1e-12);
  EXPECT_NEAR(rider.pose().z, 0.2, 1e-12);
  EXPECT_NEAR(rider.pose().heading, k_pi / 2, 1e-12);
  EXPECT_NEAR(rider.speed().forward, 0.5, 1e-12);
  EXPECT_FALSE(rider.stalled());
  step(simulation, 29);
  EXPECT_NEAR(rider.pose().x, 39 * 0.05, 1e-12);
  EXPECT_NEAR(rider.pose().y, 1, 1e-9);
  EXPECT_TRUE(rider.stalled());
  EXPECT_FALSE(simulation.find("carrier").stalled()) << "the rider stands, its carrier goes on";
  EXPECT_NEAR(simulation.find("carrier").ranges("rider.ranger:0")[0], 0.13, 1e-5);
}

TEST_F(StageGrip, APositionInsideAnotherObeysTheProgram) {
  Simulation simulation = load(
      "position( name \"c\" position( name \"r\" size [0.1 0.1 0.1] drive \"omni\" pose [0.1 0 0 0] ) )\n");
  simulation.find("c.r").set_speed(0.2, -0.1, 0);
  simulation.find("c").set_speed(0, 1);
  step(simulation, 10);
  const Pose expected = compose(simulation.find("c").pose(), {0.1 + 0.2, -0.1, 1, 0});
  EXPECT_NEAR(expected.heading, 1, 1e-12);
  EXPECT_NEAR(simulation.find("c.r").pose().x, expected.x, 1e-12);
  EXPECT_NEAR(simulation.find("c.r").pose().y, expected.y, 1e-12);
  simulation.find("c").set_speed(0, 0);
  simulation.find("c.r").go_to(1, 1, 0);  // the world's frame, as what it knows
  step(simulation, 120);
  EXPECT_NEAR(simulation.find("c.r").pose().x, 1, 0.03);
  EXPECT_NEAR(simulation.find("c.r").pose().y, 1, 0.03);
}

TEST_F(StageGrip, APlanIsOneWord) {
  Simulation simulation = load(
      "position( name \"r\" ctrl \"operate gripper:0:close@0.2,gripper:0:up@3,gripper:0:open@6\"\n"
      "  gripper() )\n");
  step(simulation, 60);
  EXPECT_EQ(state<GripperState>(simulation, "r", "gripper:0").paddles, GripperState::closed);
  EXPECT_EQ(state<GripperState>(simulation, "r", "gripper:0").lift, GripperState::is_up);
  step(simulation, 30);
  EXPECT_EQ(state<GripperState>(simulation, "r", "gripper:0").paddles, GripperState::is_open);
  const auto error_of = [&](const std::string& plan) -> std::string {
    try {
      load("position( ctrl \"operate " + plan + "\" gripper( name \"hand\" ) actuator( name \"arm\" ) )");
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(
      error_of("hand:close"),
      HasSubstr("w.world:1: error: controller \"operate\" has a plan with \"hand:close\", which is not "
                "DEVICE:ORDER@SECONDS or DEVICE:ORDER:VALUE@SECONDS"));
  EXPECT_THAT(error_of("hand:clse@1"),
              HasSubstr("has a plan with an unknown order \"clse\"; known: close, down, "
                        "go_to, open, speed, up (did you mean \"close\"?)"));
  EXPECT_THAT(error_of("arm:go_to@1"),
              HasSubstr("\"arm:go_to@1\", whose order needs a value: write DEVICE:ORDER:VALUE@SECONDS"));
  EXPECT_THAT(error_of("hand:close:2@1"),
              HasSubstr("\"hand:close:2@1\", whose order takes no value: write DEVICE:ORDER@SECONDS"));
  EXPECT_THAT(error_of("foot:up@1"),
              HasSubstr("has an order for the unknown device \"foot\"; known: arm, hand"));
}

}  // namespace
}  // namespace troupe::stage_grip_test
