// The limits of drives in JSON worlds: one side alone, and the speeds on the way to a goal.

#include "engine/world/world.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/troupe.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace troupe::drive_limits_test {
namespace {

class DriveLimits : public test::ScratchTest {
 protected:
  /// A world with the robot "r" of the type "bot", whose drive has these further keys. more: further keys of
  /// the world.
  Simulation world(const std::string& drive, const std::string& more = "",
                   SimulationOptions options = {.threads = 1}) {
    return Simulation(write("world.json", fmt::format(R"({{"troupe": 1{}, "types": {{
                                            "bot": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "omni"{}}}}}}},
                                            "models": [{{"name": "r", "type": "bot"}}]}})",
                                                      more, drive)),
                      options);
  }
  static double limit(const Simulation& simulation, const std::string& name) {
    const engine::World& world = simulation.world();
    const auto& drive =
        *world.spec().types[world.spec().bodies[world.state().names.find("r").index()].type.index()].drive;
    return engine::get(simulation.registry().drive(drive.kind)->params, drive.params, name).number();
  }
};

TEST_F(DriveLimits, AMissingLimitIsMinusTheOther) {
  struct Case {
    const char *keys, *low, *high;
    double least, most;
  };
  const double half = radians(90);
  for (const Case& c : std::initializer_list<Case>{
           {"", "velocity_min_x", "velocity_max_x", -1, 1},
           {R"("velocity_max_x_mps": 0.12)", "velocity_min_x", "velocity_max_x", -0.12, 0.12},
           {R"("velocity_min_x_mps": -2)", "velocity_min_x", "velocity_max_x", -2, 2},
           {R"("velocity_max_y_mps": 0.12)", "velocity_min_y", "velocity_max_y", -0.12, 0.12},
           {R"("turn_max_radps": 3.5)", "turn_min", "turn_max", -3.5, 3.5},
           {R"("turn_min_degps": -45)", "turn_min", "turn_max", -radians(45), radians(45)},
           {R"("turn_acceleration_max_radps2": 3)", "turn_acceleration_min", "turn_acceleration_max", -3, 3},
           {R"("acceleration_min_x_mps2": -3)", "acceleration_min_x", "acceleration_max_x", -3, 3},
           {R"("acceleration_max_y_mps2": 3)", "acceleration_min_y", "acceleration_max_y", -3, 3},
           {R"("velocity_min_x_mps": 0)", "velocity_min_x", "velocity_max_x", 0, 1},
           {R"("velocity_max_x_mps": 0)", "velocity_min_x", "velocity_max_x", -1, 0},
           {R"("velocity_min_x_mps": 0.1)", "velocity_min_x", "velocity_max_x", 0.1, 1},
           {R"("velocity_max_x_mps": -0.1)", "velocity_min_x", "velocity_max_x", -1, -0.1},
           {R"("velocity_max_x_mps": 2, "velocity_min_x_mps": -0.5)", "velocity_min_x", "velocity_max_x",
            -0.5, 2},
           {R"("turn_max_radps": 3.5)", "velocity_min_x", "velocity_max_x", -1, 1},
           {R"("velocity_max_x_mps": 3)", "turn_min", "turn_max", -half, half},
       }) {
    const Simulation simulation = world((*c.keys ? ", " : "") + std::string(c.keys));
    EXPECT_EQ(limit(simulation, c.low), c.least) << c.keys;
    EXPECT_EQ(limit(simulation, c.high), c.most) << c.keys;
  }
}

TEST_F(DriveLimits, ARobotTurnsAndDrivesAsFastToBothSides) {
  Simulation simulation = world(R"(, "velocity_max_x_mps": 0.12, "turn_max_radps": 3.5)");
  Model model = simulation.find("r");
  model.set_speed(-0.5, 0, -3);
  simulation.step();
  const engine::World& engine = simulation.world();
  const engine::Velocity velocity =
      engine.view().velocities()[engine.view().row(engine.state().names.find("r")).index()];
  EXPECT_EQ(velocity.x, -0.12);
  EXPECT_EQ(velocity.turn, -3);
}

TEST_F(DriveLimits, TheOtherSideIsLookedForAfterSettings) {
  EXPECT_EQ(limit(world("", "", {.threads = 1, .set = {{"/types/bot/drive/velocity_max_x_mps", "0.5"}}}),
                  "velocity_min_x"),
            -0.5);
  const Simulation both = world(R"(, "velocity_max_x_mps": 0.5)", "",
                                {.threads = 1, .set = {{"/types/bot/drive/velocity_min_x_mps", "-0.1"}}});
  EXPECT_EQ(limit(both, "velocity_min_x"), -0.1);
  EXPECT_EQ(limit(both, "velocity_max_x"), 0.5);
}

TEST_F(DriveLimits, TheOtherSideIsLookedForAfterExtends) {
  const Simulation simulation(write("world.json", R"({"troupe": 1, "types": {
    "slow": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff", "velocity_max_x_mps": 0.5}},
    "bot": {"extends": "slow", "drive": {"velocity_min_x_mps": -0.1}}},
    "models": [{"name": "r", "type": "bot"}]})"),
                              {.threads = 1});
  EXPECT_EQ(limit(simulation, "velocity_min_x"), -0.1);
  EXPECT_EQ(limit(simulation, "velocity_max_x"), 0.5);
}

TEST_F(DriveLimits, AnInterventionSetsOnlyWhatItNames) {
  Simulation simulation =
      world("", R"(, "at": [{"time_s": 0.1, "set": {"type": "bot", "drive": {"velocity_max_x_mps": 0.3}}}])");
  Model model = simulation.find("r");
  model.set_speed(-0.8, 0, 0);
  for (int tick = 0; tick < 5; ++tick) simulation.step();
  const engine::World& engine = simulation.world();
  EXPECT_EQ(engine.view().velocities()[engine.view().row(engine.state().names.find("r")).index()].x, -0.8);
}

TEST_F(DriveLimits, GoalsAreReachedAsFastAsTheDriveAllows) {
  struct Case {
    const char* keys;
    double speed, turn;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"", 1, radians(90)},
           {R"(, "velocity_max_x_mps": 3, "turn_max_radps": 2)", 3, 2},
           {R"(, "velocity_max_x_mps": 3, "goal_speed_max_mps": 0.7, "goal_turn_max_radps": 0.5)", 0.7, 0.5},
           {R"(, "goal_speed_max_mps": 7)", 1, radians(90)}}) {
    Simulation simulation = world(c.keys);
    Model model = simulation.find("r");
    model.go_to({9, 0, 0, 3});
    simulation.step();
    const engine::World& engine = simulation.world();
    const engine::Velocity velocity =
        engine.view().velocities()[engine.view().row(engine.state().names.find("r")).index()];
    EXPECT_EQ(velocity.x, c.speed) << c.keys;
    EXPECT_EQ(velocity.turn, c.turn) << c.keys;
  }
}

TEST_F(DriveLimits, InStagesSyntaxTheSpeedsOnTheWayToAGoalAreStages) {
  const Simulation simulation(write("r.world", R"(
    define bot position ( size [0.2 0.2 0.2] velocity_bounds [-3 3 -3 3 -1 1 -180 180] )
    bot ( name "r" )
  )"),
                              {.threads = 1});
  EXPECT_EQ(limit(simulation, "goal_speed_max"), 0.4);
  EXPECT_EQ(limit(simulation, "goal_turn_max"), 1);
}

}  // namespace
}  // namespace troupe::drive_limits_test
