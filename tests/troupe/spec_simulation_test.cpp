// A Simulation of a WorldSpec that was filled by a program, or loaded from a file beforehand.

#include "base/diagnostics.hpp"
#include "engine/spec/populations.hpp"
#include "engine/world/world.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/load.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace troupe::spec_simulation_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class SpecSimulation : public test::ScratchTest {};

engine::WorldSpec load(const fs::path& file) {
  Diagnostics diagnostics;
  engine::WorldSpec spec = worldio::load_world(file, make_registry(), {}, diagnostics);
  diagnostics.throw_if_errors();
  return spec;
}

std::string log_of(Simulation simulation, int ticks = 20) {
  std::string log = simulation.hash_log_line();
  for (int i = 0; i < ticks; ++i) {
    simulation.step();
    log += "\n" + simulation.hash_log_line();
  }
  return log;
}

/// A wall, and robots that a rule places before it, made without a file.
engine::WorldSpec by_hand() {
  const engine::Registry registry = make_registry();
  const auto box = [](double x, double y, double z) {
    return Solid{{{{-x / 2, -y / 2}, {x / 2, -y / 2}, {x / 2, y / 2}, {-x / 2, y / 2}}}, {0, z}};
  };
  engine::WorldSpec spec;
  spec.title = "By hand";
  engine::add_ground(spec);
  engine::TypeSpec wall{.name = "wall"};
  wall.parts.push_back({.kind = "model", .size = {0.2, 4, 1}, .solids = {box(0.2, 4, 1)}});
  engine::TypeSpec bot{.name = "bot"};
  bot.parts.push_back({.kind = "position", .size = {0.4, 0.3, 0.25}, .solids = {box(0.4, 0.3, 0.25)}});
  bot.drive = engine::DriveSpec{.kind = "diff", .params = registry.drive("diff")->params.defaults()};
  engine::DeviceSpec eye{
      .name = "eye", .kind = "ranger", .params = registry.device("ranger")->params.defaults()};
  const engine::FieldTable& ranger = registry.device("ranger")->params;
  const auto transducers = static_cast<std::size_t>(ranger.find("transducers"));
  const engine::FieldTable& beams = *ranger.fields[transducers].record;
  engine::Record fan = beams.defaults();
  fan[static_cast<std::size_t>(beams.find("samples"))] = 9;
  fan[static_cast<std::size_t>(beams.find("fov"))] = 1.5;
  eye.params[transducers] = std::vector<engine::Record>{fan};
  bot.devices.push_back(eye);
  bot.controllers.push_back({.kind = "wander", .params = registry.controller("wander")->params.defaults()});
  spec.types.push_back(wall);
  spec.types.push_back(bot);
  spec.bodies.push_back({.name = spec.names.add("wall"), .type = TypeId(1), .pose_world_body = {2, 0, 0, 0}});
  engine::PopulationSpec swarm{.name = "r", .type = TypeId(2), .count = 9};
  swarm.rule.kind = engine::PlacementRule::Kind::uniform;
  swarm.rule.region.extend(Vec2(-5, -5));
  swarm.rule.region.extend(Vec2(5, 5));
  Diagnostics diagnostics;
  engine::place(std::span(&swarm, 1), spec, diagnostics);
  diagnostics.throw_if_errors();
  return spec;
}

std::string errors_of(const engine::WorldSpec& spec) {
  try {
    Simulation simulation(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(SpecSimulation, RunsWhatAProgramFilled) {
  Simulation simulation(by_hand());
  EXPECT_EQ(simulation.robots(), 9u);
  EXPECT_EQ(simulation.title(), "By hand");
  const Pose before = simulation.find("r0").pose();
  for (int i = 0; i < 20; ++i) simulation.step();
  EXPECT_NE(simulation.find("r0").pose(), before);
  EXPECT_EQ(simulation.find("r8").ranges().size(), 9u);
}

TEST_F(SpecSimulation, IsSavedAndResumedWithoutAFile) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  Simulation simulation(by_hand());
  for (int i = 0; i < 5; ++i) simulation.step();
  simulation.save(folder_ / "hand.h5");
  Simulation resumed = Simulation::resume(folder_ / "hand.h5");
  EXPECT_EQ(log_of(std::move(resumed)), log_of(std::move(simulation)));
}

TEST_F(SpecSimulation, ALoadedSpecIsTheWorldOfItsFile) {
  for (const char* name : {"crowd.json", "failures.json", "gripper.json", "noise.world", "lift.world"}) {
    const fs::path file = test::source_dir() / "worlds" / name;
    EXPECT_EQ(log_of(Simulation(load(file)), 5), log_of(Simulation(file), 5)) << name;
  }
}

TEST_F(SpecSimulation, OptionsReplaceWhatTheSpecSays) {
  const Simulation simulation(by_hand(), {.seed = 99, .ranging = RangingEngine::grid});
  EXPECT_EQ(simulation.seed(), 99u);
  EXPECT_EQ(simulation.world().spec().ranging, RangingEngine::grid);
  EXPECT_THROW(Simulation(by_hand(), {.robots = {{"r", 3}}}), std::invalid_argument);
  EXPECT_THROW(Simulation(by_hand(), {.set = {{"/seed", "3"}}}), std::invalid_argument);
}

TEST_F(SpecSimulation, WhatIsWrongIsNamedByItsPath) {
  const auto expect = [](auto damage, const std::string& message) {
    engine::WorldSpec spec = by_hand();
    damage(spec);
    EXPECT_THAT(errors_of(spec), HasSubstr(message));
  };
  using Spec = engine::WorldSpec;
  expect([](Spec& s) { s.types[2].parts[0].size.z() = k_nan; },
         "error: types[2].parts[0].size: must be from -1000000 to 1000000 m, found nan");
  expect(
      [](Spec& s) { s.types[2].parts[0].solids[0].contours[0][2].x() = 2e6; },
      "error: types[2].parts[0].solids[0].contours[0][2]: must be from -1000000 to 1000000 m, found 2000000");
  expect([](Spec& s) { s.types[2].parts[0].solids[0].contours[0][2].x() = 1e6 + 1e-5; },
         "error: types[2].parts[0].solids[0].contours[0][2]: must be from -1000000 to 1000000 m, found "
         "1000000.00001");
  expect([](Spec& s) { s.types[2].parts[0].solids[0].z.max = k_nan; },
         "error: types[2].parts[0].solids[0].z_m.max: must be from -1000000 to 1000000, found nan");
  expect([](Spec& s) { s.types[2].parts[0].returns.ranger = INFINITY; },
         "error: types[2].parts[0].ranger_return: must be from -1e+30 to 1e+30, found inf");
  expect([](Spec& s) { s.tick_s = 0; }, "error: tick: must be from 0.000001 to 1000000000000000 s, found 0");
  expect([](Spec& s) { s.measure_every_s = -1; },
         "error: measure_every: must be from 0 to 1000000000000000 s, found -1");
  expect([](Spec& s) { s.types[2].parts.clear(); },
         "error: types[2].parts: empty; a type needs at least one part");
  expect([](Spec& s) { s.types[2].parts[0].parent = 1; },
         "error: types[2].parts[0].parent: must be 0 for the first part, found index 1 (counted from 0)");
  expect(
      [](Spec& s) {
        s.types[2].parts.push_back(s.types[2].parts[0]);
        s.types[2].parts[1].parent = 1;
      },
      "error: types[2].parts[1].parent: must be the index of an earlier part, found index 1 (counted from "
      "0)");
  expect([](Spec& s) { s.types[2].joints.emplace_back().parent = 0; },
         "error: types[2].joints[0].parent: must be -1 (no parent) or the index of an earlier joint, found "
         "index 0 (counted from 0)");
  expect([](Spec& s) { s.types[2].devices[0].joint = 0; },
         "error: types[2].sensors[0].joint: must be -1 (no joint) or the index of a joint; the type has 0 "
         "joints, found "
         "index 0 (counted from 0)");
  expect([](Spec& s) { s.types[2].devices[0].moves = -2; },
         "error: types[2].sensors[0].moves: must be -1 (no joint) or the index of a joint; the type has 0 "
         "joints, found "
         "index -2 (counted from 0)");
  expect([](Spec& s) { s.types[2].devices[0].part = 3; },
         "error: types[2].sensors[0].part: the type has 1 part, found index 3 (counted from 0)");
  expect([](Spec& s) { s.types[2].drive->kind = "hover"; },
         "error: types[2].drive.params: unknown drive \"hover\"");
  expect([](Spec& s) { s.types[2].drive->params.pop_back(); }, "error: types[2].drive.params: expected ");
  expect([](Spec& s) { s.types[2].drive->params.front() = "fast"; },
         "the value has the wrong type: expected a number");
  expect([](Spec& s) { s.types[2].devices[0].params.front().v = std::vector<engine::Record>{{}}; },
         "error: types[2].sensors[0].params.transducers[0]: expected ");
  expect([](Spec& s) { s.bodies[3].pose_world_body.x = k_nan; },
         "error: bodies[3].pose.x: must be from -1000000 to 1000000, found nan");
  expect([](Spec& s) { s.bodies[3].type = TypeId(7); },
         "error: bodies[3].type: the world has 3 types, found index 7 (counted from 0)");
  expect(
      [](Spec& s) {
        s.bodies[3].name = {77, 0};
      },
      "error: bodies[3].name: the list of name words has 4 entries, found index 77 (counted from 0)");
  expect([](Spec& s) { s.bodies.clear(); }, "error: bodies: empty; body 0 of every world is the ground");
  expect(
      [](Spec& s) { s.bodies.erase(s.bodies.begin()); },
      "error: bodies[0]: must be the ground, which has no shape and does nothing: call add_ground() before "
      "the first body is added; found \"wall\" of type \"wall\"");
  expect(
      [](Spec& s) { s.bodies[0].type = TypeId(2); },
      "error: bodies[0]: must be the ground, which has no shape and does nothing: call add_ground() before "
      "the first body is added; found \"_ground_model\" of type \"bot\"");
  expect(
      [](Spec& s) {
        s.empty_populations = {{"r", TypeId(7)}};
      },
      "error: empty_populations[0].type: the world has 3 types, found index 7 (counted from 0)");
  expect(
      [](Spec& s) {
        for (const char* name : {"b", "a", "d", "c", "e"}) s.part_aliases[name] = {BodyId(3), "lid"};
      },
      "error: part_names: \"a\" refers to a part that does not exist");
  expect(
      [](Spec& s) {
        s.reserves = {{"r", BodyId(9), 5}};
      },
      "error: reserves[0]: reserve \"r\" refers to bodies 9 to 13, but the world has ");
  expect(
      [](Spec& s) {
        s.reserves = {{"r", BodyId(1), 0}};
      },
      "error: reserves[0]: reserve \"r\" has no bodies: give a `count` of 1 or more");
  expect(
      [](Spec& s) {
        s.reserves = {{"r", BodyId(0), 1}};
      },
      "error: reserves[0]: reserve \"r\" begins at body 0, but must begin at body 1 or later");
  expect(
      [](Spec& s) {
        s.reserves = {{"r", BodyId(1), 2}};
      },
      "error: reserves[0]: reserve \"r\" has bodies of the types \"wall\" and \"bot\"; all bodies of a "
      "reserve "
      "must have the same type");
  expect([](Spec& s) { s.bounds.emplace(); },
         "error: bounds_m.min: must be from -1000000 to 1000000, found inf");
  expect(
      [](Spec& s) {
        s.experiment.at.emplace_back().action = engine::InterventionSpec::Action::set;
        s.experiment.at[0].setting = {TypeId(1), engine::SettingSpec::Of::drive, 0, {}};
      },
      "error: experiment.at[0].setting: refers to a type, or to a drive");
  expect([](Spec& s) { s.experiment.at.emplace_back().action = engine::InterventionSpec::Action::set; },
         "error: experiment.at[0].setting: missing, but the action `set` needs the new parameters");
  expect(
      [](Spec& s) {
        engine::InterventionSpec& at = s.experiment.at.emplace_back();
        at.action = engine::InterventionSpec::Action::move;
        at.whom = {.by = engine::GroupSpec::By::model, .name = "r0", .count = {}, .share = {}};
      },
      "error: experiment.at[0].pose: missing, but the action `move` needs the new pose of the body");
  // Where a value has a place in a file, that stands in front.
  expect(
      [](Spec& s) {
        s.files = std::make_shared<SourceFiles>();
        s.types[2].drive->where = {s.files->add("robots.txt"), 12};
        s.types[2].drive->period_s = -1;
      },
      "robots.txt:12: error: types[2].drive.period: must be from 0 to 1000000000000000 s, found -1");
}

}  // namespace
}  // namespace troupe::spec_simulation_test
