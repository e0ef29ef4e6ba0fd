// Interventions and faults: they take effect at their ticks and in the selected bodies, for any number of
// threads, after a reset, and if a run continues from any tick.

#include "base/random.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/observing/events.hpp"
#include "engine/observing/remade_world.hpp"
#include "engine/observing/stop_conditions.hpp"
#include "engine/world/world.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <any>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine::experiment_test {
namespace {

using test::box;
using test::SceneBuilder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Action = InterventionSpec::Action;
using By = GroupSpec::By;

GroupSpec population(std::string name, std::optional<std::int64_t> count = {},
                     std::optional<double> share = {}) {
  return {By::population, std::move(name), count, share};
}
GroupSpec model(std::string name) { return {By::model, std::move(name), {}, {}}; }

InterventionSpec at(double time_s, Action action, GroupSpec whom) {
  return {
      .time_s = time_s, .action = action, .whom = std::move(whom), .pose = {}, .region = {}, .setting = {}};
}

FaultSpec fault(GroupSpec whom, double from_s, std::string kind,
                std::initializer_list<std::pair<std::string_view, Value>> params) {
  const Record record = test::record(test::registry().fault(kind)->params, params);
  return {std::move(whom), from_s, {{std::move(kind), record}}, {}};
}

/// `count` robots in a row along y, 1 m apart, that look ahead and were told to drive at 1 m/s.
struct Squad {
  SceneBuilder scene;
  TypeId type;
  std::size_t count;

  explicit Squad(std::size_t robots) : count(robots) {
    type = scene.robot("bot", {box(0.4, 0.4)});
    scene[type].devices = {test::ranger("eye", {{.range_max = 5}})};
    for (std::size_t i = 0; i < robots; ++i)
      scene.body(fmt::format("r{}", i), type, {0, static_cast<double>(i), 0, 0});
  }
  std::unique_ptr<World> world(WorldOptions options = {.threads = 2}) const {
    Diagnostics diagnostics;
    auto world = std::make_unique<World>(scene.spec, test::registry(), options, diagnostics);
    drive(*world);
    return world;
  }
  static void drive(World& world) {
    for (std::size_t r = 0; r < world.view().rows(); ++r)
      if (world.view().is_there(Row(r))) world.set_command(Row(r), {1, 0, 0});
  }
  std::string errors() const {
    Diagnostics diagnostics(scene.spec.files);
    try {
      World(scene.spec, test::registry(), {.threads = 1}, diagnostics);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

void step(World& world, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) world.step();
}

std::vector<std::string> there(const World& world) {
  std::vector<std::string> names;
  for (std::size_t b = 1; b < world.spec().bodies.size(); ++b)
    if (const Row row = world.view().row(BodyId(b)); row.valid() && world.view().is_there(row))
      names.push_back(world.spec().name(BodyId(b)));
  return names;
}

double x_of(const World& world, std::string_view name) {
  return world.view().pose(world.state().names.find(name)).x;
}

TEST(Experiment, WhatIsDoneAtATimeIsDoneAsAProgramWouldBetweenItsTicks) {
  Squad row(4);
  row.scene.spec.mortal = true;
  const auto plain = row.world();
  row.scene.spec.experiment.at = {at(1, Action::remove, model("r2")), at(0, Action::remove, model("r0"))};
  const auto world = row.world();
  plain->remove(plain->view().row(plain->state().names.find("r0")));
  for (int tick = 0; tick < 20; ++tick) {
    if (tick == 10) plain->remove(plain->view().row(plain->state().names.find("r2")));
    plain->step();
    world->step();
    ASSERT_EQ(world->hashes().state, plain->hashes().state) << "tick " << world->tick();
  }
  EXPECT_THAT(there(*world), ElementsAre("r1", "r3"));
}

TEST(Experiment, ATimeBetweenTwoTicksIsRoundedUp) {
  Squad row(2);
  row.scene.spec.experiment.at = {at(0.25, Action::remove, model("r0"))};
  const auto world = row.world();
  step(*world, 3);
  EXPECT_EQ(world->robots(), 2u) << "tick 3, 0.3 s, is the last with it";
  world->step();
  EXPECT_EQ(world->robots(), 1u);
}

TEST(Experiment, SoManyAreChosenBySeedAndPlaceInTheList) {
  const auto left = [](std::uint64_t seed, std::vector<InterventionSpec> list) {
    Squad row(30);
    row.scene.spec.seed = seed;
    row.scene.spec.experiment.at = std::move(list);
    const auto world = row.world();
    step(*world, 12);
    return there(*world);
  };
  const InterventionSpec ten = at(1, Action::remove, population("r", 10));
  EXPECT_EQ(left(1, {ten}).size(), 20u);
  EXPECT_EQ(left(1, {ten}), left(1, {ten}));
  EXPECT_NE(left(1, {ten}), left(2, {ten}));
  EXPECT_NE(left(1, {ten}), left(1, {at(5, Action::remove, model("r3")), ten}));
  EXPECT_EQ(left(1, {ten, at(0.5, Action::remove, population("r", {}, 0.25))}).size(), 30u - 8 - 10)
      << "a quarter of 30 is 7.5, of which 8 are the nearest";
  EXPECT_EQ(left(1, {at(1, Action::remove, population("r", 100))}).size(), 0u);
  EXPECT_EQ(left(1, {at(1, Action::remove, {By::type, "bot", 29, {}})}).size(), 1u);
}

TEST(Experiment, EveryoneIsChosenAsOftenAsTheOthers) {
  std::vector<int> removed(10);
  constexpr int k_seeds = test::k_slow_build ? 40 : 400;
  for (int seed = 0; seed < k_seeds; ++seed) {
    Squad row(10);
    row.scene.spec.seed = static_cast<std::uint64_t>(seed);
    row.scene.spec.experiment.at = {at(0, Action::remove, population("r", 3))};
    const auto world = row.world({.threads = 1});
    world->step();
    for (std::size_t i = 0; i < removed.size(); ++i)
      removed[i] +=
          !world->view().is_there(world->view().row(world->state().names.find(fmt::format("r{}", i))));
  }
  // Binomial, p = 0.3: within four standard deviations.
  const double sigma = std::sqrt(k_seeds * 0.3 * 0.7);
  for (const int count : removed) EXPECT_NEAR(count, 0.3 * k_seeds, 4 * sigma);
}

TEST(Experiment, WhoIsDisabledStandsStillAndSeesNothingUntilItIsEnabled) {
  Squad row(2);
  row.scene.wall(5, -1, 6, 5);
  row.scene.spec.experiment.at = {at(1, Action::disable, model("r0")), at(2, Action::enable, model("r0"))};
  const auto world = row.world();
  const Row r0 = world->view().row(world->state().names.find("r0"));
  const auto range = [&](std::string_view name) {
    const Row r = world->view().row(world->state().names.find(name));
    return world->tables()[world->view().type(r).devices[0].table].cell<float>(world->view().slot(r), 0)[0];
  };
  step(*world, 10);
  EXPECT_NEAR(x_of(*world, "r0"), 1, 1e-12);
  EXPECT_FALSE(world->view().is_disabled(r0));
  const float seen = range("r0");
  EXPECT_FLOAT_EQ(seen, 5 - 0.9f) << "of tick 9, which tick 10 has looked at";
  step(*world, 10);
  EXPECT_TRUE(world->view().is_disabled(r0));
  EXPECT_EQ(test::count_impaired(*world), 1u);
  EXPECT_NEAR(x_of(*world, "r0"), 1, 1e-12);
  EXPECT_NEAR(x_of(*world, "r1"), 2, 1e-12);
  EXPECT_EQ(range("r0"), seen);
  EXPECT_FLOAT_EQ(range("r1"), 5 - 1.9f);
  EXPECT_EQ(world->view().velocities()[r0.index()].x, 0);
  EXPECT_FALSE(world->view().stalled(r0));
  EXPECT_EQ(world->counters().beams, 10u * 2 + 10);
  step(*world, 10);
  EXPECT_FALSE(world->view().is_disabled(r0));
  EXPECT_NEAR(x_of(*world, "r0"), 2, 1e-12) << "it goes on as it was told before";
  EXPECT_FLOAT_EQ(range("r0"), 5 - 1.9f);
}

TEST(Experiment, EventsTellWhoFailsAndRecovers) {
  Squad row(3);
  row.scene.spec.experiment.at = {at(0.1, Action::disable, model("r0")),
                                  at(0.1, Action::disable, model("r2")), at(0.2, Action::enable, model("r0")),
                                  at(0.2, Action::remove, model("r2"))};
  const auto world = row.world();
  EventWatch watch(*world);
  std::vector<std::string> lines;
  for (int tick = 0; tick < 4; ++tick) {
    world->step();
    for (const Event& event : watch.see(*world))
      lines.push_back(
          fmt::format("{} {} {}", world->tick(), event_name(event.type), world->spec().name(event.body)));
  }
  EXPECT_THAT(lines, ElementsAre("2 fails r0", "2 fails r2", "3 recovers r0", "3 death r2"));
}

TEST(Experiment, OfThoseDisabledSomeAreEnabled) {
  Squad row(10);
  row.scene.spec.experiment.at = {at(0.1, Action::disable, population("r", 6)),
                                  at(0.2, Action::disable, population("r", 2)),
                                  at(0.3, Action::enable, population("r", {}, 0.5))};
  const auto world = row.world();
  const auto out = [&] {
    std::size_t count = 0;
    for (std::size_t r = 0; r < world->view().rows(); ++r) count += world->view().is_disabled(Row(r));
    return count;
  };
  std::vector<std::size_t> counts;
  for (int tick = 0; tick < 5; ++tick) {
    world->step();
    counts.push_back(out());
  }
  EXPECT_THAT(counts, ElementsAre(0, 6, 8, 4, 4)) << "the second two are others, and half of eight is four";
}

TEST(Experiment, DeadSensorsKeepTheirReadings) {
  Squad row(2);
  row.scene.wall(5, -1, 6, 5);
  row.scene[row.type].devices.push_back(test::ranger("back", {{.pose = {0, 0, 0, k_pi}, .range_max = 5}}));
  row.scene.spec.experiment.faults = {fault(model("r0"), 0.5, "dead_sensors", {{"sensors", "eye"}})};
  const auto world = row.world();
  step(*world, 20);
  const auto range = [&](std::string_view name, std::size_t device) {
    const Row r = world->view().row(world->state().names.find(name));
    return world->tables()[world->view().type(r).devices[device].table].cell<float>(world->view().slot(r),
                                                                                    0)[0];
  };
  EXPECT_FLOAT_EQ(range("r0", 0), 5 - 0.4f) << "of tick 4, as tick 5 saw it";
  EXPECT_FLOAT_EQ(range("r1", 0), 5 - 1.9f);
  EXPECT_NEAR(x_of(*world, "r0"), 2, 1e-12) << "it drives on";
  EXPECT_EQ(world->counters().beams, 20u * 4 - 15) << "the others look on";
}

TEST(Experiment, SlowWheelsGiveTheirShareOfEverySpeed) {
  Squad row(4);
  row.scene.spec.experiment.faults = {fault(model("r0"), 0, "slow_wheels", {{"factor", 0.5}}),
                                      fault(model("r2"), 0, "slow_wheels", {{"factor", 0.25}}),
                                      fault(model("r2"), 0.5, "slow_wheels", {{"factor", 0.5}})};
  const auto world = row.world();
  for (const std::string_view name : {"r2", "r3"})
    world->set_command(world->view().row(world->state().names.find(name)),
                       {0.3, 0, 0.1, ControlMode::acceleration});
  step(*world, 5);
  EXPECT_EQ(2 * x_of(*world, "r0"), x_of(*world, "r1")) << "powers of two lose nothing";
  EXPECT_NEAR(x_of(*world, "r0"), 0.25, 1e-12);
  const auto speed = [&](std::string_view name) {
    return world->view().velocities()[world->view().row(world->state().names.find(name)).index()];
  };
  EXPECT_EQ(4 * speed("r2").x, speed("r3").x) << "what it accelerates is what it would have";
  EXPECT_EQ(4 * speed("r2").turn, speed("r3").turn);
  step(*world, 5);
  EXPECT_EQ(8 * speed("r2").x, speed("r3").x) << "two faults, an eighth";
}

TEST(Experiment, DropOutsComeAsAPoissonProcessWould) {
  constexpr std::size_t k_squad = test::k_slow_build ? 200 : 1000;
  Squad row(k_squad);
  row.scene.spec.experiment.faults = {fault(population("r"), 1, "drop_out", {{"rate", 0.1}})};
  const auto world = row.world();
  step(*world, 11);
  EXPECT_LE(test::count_impaired(*world), k_squad / 20u) << "from 1 s on";
  step(*world, 100);
  // 10 s after it began 1 - exp(-1) of them are out, within four standard deviations.
  const double share = 1 - std::exp(-1.0);
  EXPECT_NEAR(static_cast<double>(test::count_impaired(*world)), share * k_squad,
              4 * std::sqrt(k_squad * share * (1 - share)));
}

TEST(Experiment, DropOutsThatPassComeAgain) {
  constexpr std::size_t k_squad = test::k_slow_build ? 200 : 1000;
  Squad row(k_squad);
  row.scene.spec.experiment.faults = {fault(population("r"), 0, "drop_out", {{"rate", 1.0}, {"for", 1.0}})};
  const auto world = row.world();
  step(*world, 100);
  // In for 1 s on average, and half a tick as ticks round up; out for 1 s.
  const double share = 1 / 2.05;
  EXPECT_NEAR(static_cast<double>(test::count_impaired(*world)), share * k_squad,
              4 * std::sqrt(k_squad * share * (1 - share)));
}

TEST(Experiment, AFailureLastsAsLongAsItSaysRoundedUpToTicks) {
  for (const auto& [lasts_s, ticks] : {std::pair(0.4, 4), std::pair(0.25, 3), std::pair(0.01, 1)}) {
    Registry registry = test::registry();
    static double lasts;
    lasts = lasts_s;
    registry.faults.push_back({"once", "", {}, [](const Record&, const BodyType&) {
                                 return Result<Impairment>({.drops_out = true, .lasts_s = lasts});
                               }});
    Squad row(1);
    row.scene.spec.experiment.faults = {{model("r0"), 0.3, {{"once", {}}}, {}}};
    Diagnostics diagnostics;
    World world(row.scene.spec, registry, {.threads = 1}, diagnostics);
    Squad::drive(world);
    std::vector<int> stood;  // the ticks in which it did not move
    for (int tick = 1; tick <= 12; ++tick) {
      const double x = x_of(world, "r0");
      world.step();
      if (x_of(world, "r0") == x) stood.push_back(tick);
    }
    std::vector<int> expected;
    for (int tick = 4; tick < 4 + ticks; ++tick) expected.push_back(tick);  // 0.3 s is the end of tick 3
    EXPECT_EQ(stood, expected) << lasts_s;
  }
}

TEST(Experiment, BodiesOfAReserveAreNotAmongThoseThatFail) {
  Squad row(10);
  row.scene.spec.reserves.push_back({"more", BodyId(row.scene.spec.bodies.size()), 10});
  for (int i = 0; i < 10; ++i) row.scene.body(fmt::format("more{}", i), row.type);
  row.scene.spec.experiment.faults = {fault({By::type, "bot", {}, 0.5}, 0, "slow_wheels", {{"factor", 0.5}})};
  const auto world = row.world();
  step(*world, 1);
  EXPECT_EQ(test::count_impaired(*world), 5u) << "half of those that are there";
}

TEST(Experiment, AShareOfThemFailsWithAllThatTheEntryNames) {
  Squad row(20);
  FaultSpec both = fault(population("r", {}, 0.3), 0, "slow_wheels", {{"factor", 0.5}});
  both.impairments.push_back({"dead_sensors", {""}});
  row.scene.spec.experiment.faults = {both};
  const auto world = row.world();
  step(*world, 10);
  std::size_t slow = 0;
  for (std::size_t i = 0; i < row.count; ++i) {
    const Row r = world->view().row(world->state().names.find(fmt::format("r{}", i)));
    const bool is_slow = world->view().poses()[r.index()].x < 0.75;
    slow += is_slow;
    EXPECT_EQ(world->view().works(r, world->view().type(r).devices[0]), !is_slow);
  }
  EXPECT_EQ(slow, 6u);
}

TEST(Experiment, OthersAreAddedWhereTheyAreFree) {
  Squad row(2);
  row.scene.spec.reserves.push_back({"more", BodyId(row.scene.spec.bodies.size()), 50});
  for (int i = 0; i < 50; ++i) row.scene.body(fmt::format("more{}", i), row.type);
  Box region;
  region.extend(Vec2(-3, -3));
  region.extend(Vec2(3, -1));
  InterventionSpec some = at(0.5, Action::add, population("more", 20));
  some.region = region;
  InterventionSpec one = at(0.5, Action::add, population("more", 2));
  one.pose = Pose{9, 9, 0, 1};
  InterventionSpec rest = at(1, Action::add, population("more"));
  rest.region = Box::around(Vec2(0, 30), 20);
  row.scene.spec.experiment.at = {some, one, rest};
  const auto world = row.world();
  step(*world, 6);
  EXPECT_EQ(world->robots(), 2u + 20 + 1) << "one pose holds one";
  EXPECT_EQ(world->view().pose(world->state().names.find("more20")), (Pose{9, 9, 0, 1}));
  for (std::size_t a = 0; a < world->view().rows(); ++a) {
    if (!world->view().is_there(Row(a))) continue;
    for (std::size_t b = 0; b < a; ++b) {
      if (!world->view().is_there(Row(b))) continue;
      const auto& shape = world->view().type(Row(a)).obstacle;
      EXPECT_FALSE(overlap(shape, world->view().poses()[a], shape, world->view().poses()[b]));
    }
  }
  for (int i = 0; i < 20; ++i)
    EXPECT_TRUE(
        region.contains(world->view().pose(world->state().names.find(fmt::format("more{}", i))).position()));
  step(*world, 5);
  EXPECT_EQ(world->lives().unborn(0), 0u);
  EXPECT_EQ(world->robots(), 52u);
}

// Comparing each name with those of all reserves would take minutes.
TEST(Experiment, ThereMayBeManyReserves) {
  constexpr std::size_t k_reserves = 200000;
  Squad row(1);
  for (std::size_t i = 0; i < k_reserves; ++i) {
    const std::string name = fmt::format("one_of_very_many{:06}x", i);
    row.scene.spec.reserves.push_back({name, BodyId(row.scene.spec.bodies.size()), 1});
    row.scene.body(name + "0", row.type);
    InterventionSpec add = at(1000, Action::add, population(name));
    add.pose = Pose{9, 9, 0, 0};
    row.scene.spec.experiment.at.push_back(std::move(add));
  }
  row.scene.spec.experiment.at.back().time_s = 0;
  const auto world = row.world();
  step(*world, 1);
  EXPECT_EQ(world->lives().unborn(k_reserves - 1), 0u);
  EXPECT_EQ(world->robots(), 2u);
}

// Collecting the names of all robots for each error would take most of a minute.
TEST(Experiment, ManyModelsMayBeUnknown) {
  Squad row(90000);
  row.scene[row.type].devices.clear();
  for (int i = 0; i < 900; ++i)
    row.scene.spec.experiment.at.push_back(at(1, Action::remove, model(fmt::format("unknown{}", i))));
  EXPECT_THAT(row.errors(), HasSubstr("unknown model \"unknown0\"; known: r0, r1, r10, "));
}

TEST(Experiment, WhoIsAddedAtARandomPlaceHasTheHeightOfItsReserve) {
  Squad row(1);
  row.scene.spec.reserves.push_back({"fly", BodyId(row.scene.spec.bodies.size()), 3});
  for (int i = 0; i < 3; ++i) row.scene.body(fmt::format("fly{}", i), row.type, {0, 0, 2 + 0.5 * i, 0});
  InterventionSpec at_random = at(0.1, Action::add, population("fly", 2));
  at_random.region = Box::around(Vec2(0, 30), 20);
  InterventionSpec at_a_pose = at(0.2, Action::add, population("fly"));
  at_a_pose.pose = Pose{0, -9, 1, 0};
  row.scene.spec.experiment.at = {at_random, at_a_pose};
  const auto world = row.world();
  step(*world, 3);
  EXPECT_EQ(world->view().pose(world->state().names.find("fly0")).z, 2);
  EXPECT_EQ(world->view().pose(world->state().names.find("fly1")).z, 2.5);
  EXPECT_EQ(world->view().pose(world->state().names.find("fly2")).z, 1);
}

TEST(Experiment, WhoFindsNoPlaceIsNotAdded) {
  Squad row(1);
  row.scene.spec.reserves.push_back({"more", BodyId(row.scene.spec.bodies.size()), 9});
  for (int i = 0; i < 9; ++i) row.scene.body(fmt::format("more{}", i), row.type);
  InterventionSpec all = at(0, Action::add, population("more"));
  all.region = Box::around(Vec2(9, 9), 0.2);  // of two bodies of 0.4 m the second overlaps the first
  row.scene.spec.experiment.at = {all};
  const auto world = row.world();
  step(*world, 1);
  EXPECT_EQ(world->robots(), 2u);
  EXPECT_EQ(world->lives().unborn(0), 8u);
}

TEST(Experiment, WhoIsAddedIsSeenAtOnceAndLooksAnywhere) {
  Squad row(1);
  row.scene.spec.reserves.push_back({"more", BodyId(row.scene.spec.bodies.size()), 40});
  for (int i = 0; i < 40; ++i) row.scene.body(fmt::format("more{}", i), row.type);
  InterventionSpec ahead = at(0, Action::add, population("more", 3));
  ahead.pose = Pose{2, 0, 0, 0};  // there is room for one
  InterventionSpec rest = at(0.1, Action::add, population("more"));
  rest.region = Box::around(Vec2(0, 30), 20);
  row.scene.spec.experiment.at = {ahead, rest};
  const auto world = row.world();
  step(*world, 1);
  EXPECT_FLOAT_EQ(world->tables()[world->view().type(Row(0)).devices[0].table].cell<float>(
                      world->view().slot(Row(0)), 0)[0],
                  1.8f);
  step(*world, 1);
  ASSERT_EQ(world->lives().unborn(0), 0u);
  std::vector<int> quarters(4);
  for (int i = 1; i < 40; ++i) {
    const double heading = world->view().pose(world->state().names.find(fmt::format("more{}", i))).heading;
    ++quarters[static_cast<std::size_t>(std::min(3.0, (heading + k_pi) / (k_pi / 2)))];
  }
  // Binomial, 39 draws with p = 1/4: 9.75 with a standard deviation of 2.7. More than three of them.
  for (const int count : quarters) EXPECT_NEAR(count, 9.75, 8.75);
}

TEST(Experiment, ABodyIsPutElsewhereAndSeenThere) {
  Squad row(2);
  InterventionSpec there = at(0.3, Action::move, model("r1"));
  there.pose = Pose{3, 0, 0, 7};
  row.scene.spec.experiment.at = {there};
  const auto world = row.world();
  for (std::size_t r = 0; r < 2; ++r) world->set_command(Row(r), {});
  step(*world, 3);
  EXPECT_EQ(world->view().pose(world->state().names.find("r1")).y, 1);
  step(*world, 1);
  EXPECT_EQ(world->view().pose(world->state().names.find("r1")), (Pose{3, 0, 0, wrap_angle(7)}));
  const Row r0 = world->view().row(world->state().names.find("r0"));
  EXPECT_FLOAT_EQ(
      world->tables()[world->view().type(r0).devices[0].table].cell<float>(world->view().slot(r0), 0)[0],
      static_cast<float>(3 - 0.2 / std::cos(7 - 2 * k_pi)));
}

TEST(Experiment, WhatIsAddedMeetsWhoWasMovedInTheSameTick) {
  Squad row(4);
  row.scene.spec.reserves.push_back({"more", BodyId(row.scene.spec.bodies.size()), 5});
  for (int i = 0; i < 5; ++i) row.scene.body(fmt::format("more{}", i), row.type);
  const auto with_pose = [](Action action, GroupSpec whom, double x, double y) {
    InterventionSpec spec = at(0, action, std::move(whom));
    spec.pose = Pose{x, y, 0, 0};
    return spec;
  };
  const auto move = [&](std::string name, double x, double y) {
    return with_pose(Action::move, model(std::move(name)), x, y);
  };
  const auto add = [&](double x, double y) { return with_pose(Action::add, population("more", 1), x, y); };
  row.scene.spec.experiment.at = {move("r0", 5, 0),
                                  move("r1", 5, 1),
                                  move("r0", 6, 0),
                                  add(6, 0),  // r0 is here
                                  add(5, 0),  // r0 was here for a moment
                                  at(0, Action::remove, model("r2")),
                                  move("r1", 0, 2),
                                  add(5, 1),
                                  add(0, 2),  // r1 is here, in the place of r2
                                  move("more0", 0, 0),
                                  at(0, Action::remove, model("more1")),
                                  add(5, 1)};
  const auto world = row.world();
  for (std::size_t r = 0; r < world->view().rows(); ++r) world->set_command(Row(r), {});
  world->step();
  EXPECT_THAT(there(*world), ElementsAre("r0", "r1", "r3", "more0", "more2"));
  const auto position = [&](std::string_view name) {
    return world->view().pose(world->state().names.find(name)).position();
  };
  EXPECT_EQ(position("r0"), Vec2(6, 0));
  EXPECT_EQ(position("r1"), Vec2(0, 2));
  EXPECT_EQ(position("more0"), Vec2(0, 0));
  EXPECT_EQ(position("more2"), Vec2(5, 1));
  EXPECT_EQ(world->measured().placed_before_step().size(), 3u) << "r0, r1 and more0";
}

TEST(Experiment, AnEntryForEachOfManyGroupsTakesNoSearchOfAllBodies) {
  constexpr std::size_t k_robots = test::k_slow_build ? 10'000 : 60'000;
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.4, 0.4)});
  for (std::size_t i = 0; i < k_robots; ++i) {
    scene.body(fmt::format("p{}x0", i), type,
               {static_cast<double>(i % 250), static_cast<double>(i / 250), 0, 0});
    scene.spec.experiment.at.push_back(at(0, Action::disable, population(fmt::format("p{}x", i))));
  }
  World world = scene.world();
  world.step();
  EXPECT_EQ(test::count_impaired(world), k_robots);
}

TEST(Experiment, AGroupHasAllBodiesWhoseNamesContinueInDigits) {
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.4, 0.4)});
  const std::vector<std::string> names{"team12",  "team1",          "team1x3", "team1234567890123",
                                       "team107", "team1000000001", "team",    "tea12",
                                       "team2"};
  for (std::size_t i = 0; i < names.size(); ++i)
    scene.body(names[i], type, {static_cast<double>(i), 0, 0, 0});
  const World world = scene.world();
  Groups groups(world.state());
  Diagnostics diagnostics;
  const auto members = [&](const GroupSpec& group) {
    std::vector<std::string> found;
    for (const BodyId body : *groups.find(group, {}, diagnostics)) found.push_back(world.spec().name(body));
    return found;
  };
  EXPECT_THAT(members(population("team1")),
              ElementsAre("team12", "team1234567890123", "team107", "team1000000001"));
  EXPECT_THAT(members(population("team")),
              ElementsAre("team12", "team1", "team1234567890123", "team107", "team1000000001", "team2"));
  EXPECT_THAT(members(population("team1x")), ElementsAre("team1x3"));
  EXPECT_THAT(members({By::type, "bot", {}, {}}), ::testing::ElementsAreArray(names));
  EXPECT_FALSE(diagnostics.has_errors());
}

TEST(Experiment, EntriesOnOneGroupShareOneList) {
  Squad row(3);
  const auto world = row.world();
  Diagnostics diagnostics;
  Groups groups(world->state());
  const Groups::Bodies all = groups.find(population("r"), {}, diagnostics);
  EXPECT_THAT(*all, ElementsAre(BodyId(1), BodyId(2), BodyId(3)));
  EXPECT_EQ(groups.find(population("r", 2, 0.5), {}, diagnostics), all);
  EXPECT_NE(groups.find({By::type, "bot", {}, {}}, {}, diagnostics), all);
  EXPECT_THAT(*groups.find(model("r1"), {}, diagnostics), ElementsAre(BodyId(2)));
  for (int time = 0; time < 2; ++time) EXPECT_THAT(*groups.find(model("q"), {}, diagnostics), IsEmpty());
  EXPECT_EQ(diagnostics.findings().size(), 2u) << "each use of a wrong name is an error";
}

TEST(Experiment, ARobotWithVerySlowWheelsDoesNotDriveAtFullSpeed) {
  Squad row(3);
  row.scene.spec.experiment.faults = {fault(model("r0"), 0, "slow_wheels", {{"factor", 1e-200}}),
                                      fault(model("r0"), 0, "slow_wheels", {{"factor", 1e-200}}),
                                      fault(model("r1"), 0, "slow_wheels", {{"factor", 1e-310}})};
  const auto world = row.world();
  world->set_command(world->view().row(world->state().names.find("r1")),
                     {0.3, 0, 0.1, ControlMode::acceleration});
  step(*world, 10);
  EXPECT_LT(x_of(*world, "r0"), 1e-100) << "although the product of the factors is 0";
  EXPECT_LT(x_of(*world, "r1"), 1e-100);
  EXPECT_NEAR(x_of(*world, "r2"), 1, 1e-12);
}

InterventionSpec setting(double time_s, TypeId type, SettingSpec::Of of, const FieldTable& table,
                         std::string_view name, Value value) {
  Record params(table.fields.size());
  get(table, params, name) = std::move(value);
  InterventionSpec set = at(time_s, Action::set, {});
  set.setting = SettingSpec{type, of, 0, params};
  return set;
}

TEST(Experiment, ParametersAreSetForATimeAndByTheNextReset) {
  Squad row(1);
  const FieldTable& drive = test::registry().drive("diff")->params;
  const FieldTable& ranger = test::registry().device("ranger")->params;
  row.scene.wall(5, -1, 6, 1);
  Record fan = test::ranger("eye", {{.range_max = 2}}).params;
  row.scene.spec.experiment.at = {
      setting(2, row.type, SettingSpec::Of::drive, drive, "velocity_max_x", 0.25),
      setting(1, row.type, SettingSpec::Of::drive, drive, "velocity_max_x", 0.5),
      setting(1, row.type, SettingSpec::Of::drive, drive, "velocity_min_x", -0.125),
      setting(2.5, row.type, SettingSpec::Of::device, ranger, "transducers", fan[0])};
  const auto world = row.world();
  std::vector<std::uint64_t> first;
  for (int round = 0; round < 2; ++round) {
    step(*world, 10);
    EXPECT_NEAR(x_of(*world, "r0"), 1, 1e-12);
    step(*world, 10);
    EXPECT_NEAR(x_of(*world, "r0"), 1.5, 1e-12);
    world->set_command(Row(0), {-1, 0, 0});
    step(*world, 5);
    EXPECT_NEAR(x_of(*world, "r0"), 1.5 - 0.5 * 0.125, 1e-12) << "what was set before stays";
    const auto range = [&] {
      return world->tables()[world->view().type(Row(0)).devices[0].table].cell<float>(0, 0)[0];
    };
    EXPECT_GT(range(), 3);
    world->set_command(Row(0), {1, 0, 0});
    step(*world, 5);
    EXPECT_NEAR(x_of(*world, "r0"), 1.5 - 0.5 * 0.125 + 0.5 * 0.25, 1e-12);
    EXPECT_EQ(range(), 2);
    first.push_back(world->hashes().state);
    world->reset();
    row.drive(*world);
  }
  EXPECT_EQ(first[0], first[1]);
}

/// A controller whose speed depends on the reach that its device had when the controller was prepared.
struct ByReach {
  struct Params {
    double factor = 0.01;

    static constexpr void describe(Description<Params>& d) {
      d.member<&Params::factor>("factor", "speed, m/s, per metre of reach");
    }
  };

  Params params;
  double reach_m = 0;

  std::vector<std::size_t> choose(std::span<const DeviceInfo> devices, std::vector<bool>&) {
    reach_m = devices[0].prepared.reach_m;
    return {0};
  }
  void operator()(const Percept&, Random&, Actions& actions) const {
    actions.command.x = params.factor * reach_m;
  }
};

/// A setting of the range of the ranger of a Squad.
InterventionSpec range_setting(double time_s, TypeId type, double range_max) {
  const Record fan = test::ranger("eye", {{.range_max = range_max}}).params;
  return setting(time_s, type, SettingSpec::Of::device, test::registry().device("ranger")->params,
                 "transducers", fan[0]);
}

TEST(Experiment, WhatAProgramSetsIsTheSameInAWorldThatIsMadeAgain) {
  Registry registry = test::registry();
  registry.controllers.push_back(make_controller_kind<ByReach>("by_reach", ""));
  const FieldTable& table = registry.controllers.back().params;
  Squad row(1);
  row.scene[row.type].controllers = {{.kind = "by_reach", .params = table.defaults()}};
  Diagnostics diagnostics;
  World world(row.scene.spec, registry, {.threads = 1}, diagnostics);
  step(world, 3);
  ASSERT_TRUE(world.set(*range_setting(0, row.type, 2).setting, registry));
  ASSERT_TRUE(
      world.set(*setting(0, row.type, SettingSpec::Of::controller, table, "factor", 0.02).setting, registry));
  step(world, 2);
  const std::unique_ptr<World> again = remade_world(world, registry, {.threads = 1});
  step(world, 2);
  step(*again, 2);
  EXPECT_EQ(world.view().commands()[0].x, again->view().commands()[0].x);
  EXPECT_EQ(world.hashes().state, again->hashes().state);
}

TEST(Experiment, AProgramMaySetAParameterInEveryTick) {
  constexpr int k_ticks = test::k_slow_build ? 1'000 : 20'000;
  const FieldTable& table = test::registry().drive("diff")->params;
  Squad row(1);
  const auto world = row.world({.threads = 1});
  InterventionSpec set = setting(0, row.type, SettingSpec::Of::drive, table, "velocity_max_x", 0.0);
  Value& limit = get(table, set.setting->params, "velocity_max_x");
  for (int tick = 1; tick <= k_ticks; ++tick) {
    limit = 0.5 / tick;
    ASSERT_TRUE(world->set(*set.setting, test::registry()));
    world->step();
    ASSERT_EQ(world->view().velocities()[0].x, 0.5 / tick);
  }
  const TypeSpec present = world->interventions().settings().present_type(row.type);
  EXPECT_EQ(get(table, present.drive->params, "velocity_max_x"), Value(0.5 / k_ticks));
  world->reset();
  EXPECT_EQ(world->interventions().settings().present_type(row.type).drive->params,
            row.scene[row.type].drive->params);
}

TEST(Experiment, WhatAProgramSetsBeforeAnEarlierSettingStays) {
  const FieldTable& table = test::registry().drive("diff")->params;
  Squad row(1);
  const auto world = row.world({.threads = 1});
  const auto set = [&](std::string_view name, double value) {
    const InterventionSpec made = setting(0, row.type, SettingSpec::Of::drive, table, name, value);
    ASSERT_TRUE(world->set(*made.setting, test::registry())) << name;
  };
  step(*world, 3);
  const std::vector<StateTable> saved(world->tables().begin(), world->tables().end());
  const World::Counters counters = world->counters();
  const std::uint64_t hash = world->hashes().state;
  step(*world, 3);
  set("velocity_max_x", 0.25);
  ASSERT_TRUE(world->restore(3, counters, hash, [&](std::span<StateTable> into) {
    for (std::size_t t = 0; t < saved.size(); ++t) into[t] = saved[t];
  }));
  set("velocity_min_x", -0.125);
  step(*world, 5);
  EXPECT_EQ(world->view().velocities()[0].x, 0.25) << "the setting of tick 6";
  set("velocity_max_x", 0.5);
  world->set_command(Row(0), {-1, 0, 0});
  step(*world, 1);
  EXPECT_EQ(world->view().velocities()[0].x, -0.125);
}

TEST(Experiment, ARestartMakesItsFaultsWithTheParametersOfTickZero) {
  Registry registry = test::registry();
  registry.faults.push_back({"far", "", {}, [](const Record&, const BodyType& type) {
                               const double reach_m = type.devices[0].prepared.reach_m;
                               return Result<Impairment>({.speed = reach_m / 10});
                             }});
  Squad row(1);
  row.scene.spec.experiment.faults = {{model("r0"), 0, {{"far", {}}}, {}}};
  row.scene.spec.experiment.at = {range_setting(0.1, row.type, 2)};
  Diagnostics diagnostics;
  World world(row.scene.spec, registry, {.threads = 1}, diagnostics);
  const auto hash_after = [&](int ticks) {
    Squad::drive(world);
    step(world, ticks);
    return world.hashes().state;
  };
  const std::uint64_t first = hash_after(5);
  const std::vector<BodySpec> bodies = world.spec().bodies;
  world.restart(world.spec().seed, bodies, registry);
  EXPECT_EQ(hash_after(5), first);
}

/// A device whose reach, m, is the x of the last body at the start of the run.
DeviceKind seer() {
  DeviceKind kind{.name = "seer", .text = ""};
  kind.prepare = [](const Record&, const Pose&) { return DeviceKind::Prepared{.data = 0.0}; };
  kind.bind_world = [](std::any& data, const WorldSpec& world) -> Result<> {
    data = world.bodies.back().pose_world_body.x;
    return {};
  };
  kind.reach_m = [](const std::any& data) { return std::any_cast<double>(data); };
  kind.sense = [](const SenseBatch&) -> std::uint64_t { return 0; };
  return kind;
}

// The reach of a device and the effect of a fault depend on where a body starts.
TEST(Experiment, ARestartMakesDevicesAndFaultsForItsBodies) {
  Registry registry = test::registry();
  registry.devices.push_back(seer());
  registry.faults.push_back({"near", "", {}, [](const Record&, const BodyType& type) {
                               return Result<Impairment>({.speed = 1 / type.devices.back().prepared.reach_m});
                             }});
  Squad row(1);
  row.scene[row.type].devices.push_back(
      {.name = "seer", .kind = "seer", .params = {}, .active = true, .where = {}});
  row.scene.spec.experiment.faults = {{model("r0"), 0, {{"near", {}}}, {}}};
  row.scene.spec.bodies.back().pose_world_body.x = 7;
  Diagnostics diagnostics;
  World world(row.scene.spec, registry, {.threads = 1}, diagnostics);
  row.scene.spec.bodies.back().pose_world_body.x = 9;
  World fresh(row.scene.spec, registry, {.threads = 1}, diagnostics);
  world.restart(row.scene.spec.seed, row.scene.spec.bodies, registry);
  EXPECT_EQ(world.interventions().settings().longest_reach(), 9);
  for (World* each : {&world, &fresh}) {
    Squad::drive(*each);
    step(*each, 3);
  }
  EXPECT_EQ(world.hashes().state, fresh.hashes().state);
}

/// Drives with a speed, m/s, of a tenth of the reach of its last device, m.
struct FarSighted {
  double speed = 0;
  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>&) {
    speed = devices.back().prepared.reach_m / 10;
    return std::vector<std::size_t>{devices.size() - 1};
  }
  void operator()(const Percept&, Random&, Actions& actions) const { actions.command = {speed, 0, 0}; }
};

// A controller without the hook bind_world may depend on where a body starts, by the reach of a device.
TEST(Experiment, ARestartPreparesControllersWithTheNewReachOfDevices) {
  Registry registry = test::registry();
  registry.devices.push_back(seer());
  registry.controllers.push_back(make_controller_kind<FarSighted>("far_sighted", ""));
  ASSERT_EQ(registry.controllers.back().bind_world, nullptr);
  Squad row(1);
  row.scene[row.type].devices.push_back(
      {.name = "seer", .kind = "seer", .params = {}, .active = true, .where = {}});
  row.scene[row.type].controllers = {{.kind = "far_sighted", .params = {}}};
  row.scene.spec.bodies.back().pose_world_body.x = 7;
  Diagnostics diagnostics;
  World world(row.scene.spec, registry, {.threads = 1}, diagnostics);
  row.scene.spec.bodies.back().pose_world_body.x = 9;
  world.restart(row.scene.spec.seed, row.scene.spec.bodies, registry);
  step(world, 1);
  EXPECT_EQ(world.view().commands().back().x, 0.9);
}

// ---- errors

TEST(Experiment, WhatCannotBeDoneIsToldWithItsPlace) {
  const auto errors = [](auto&& change) {
    Squad row(3);
    row.scene.spec.files = std::make_shared<SourceFiles>();
    const Where where{row.scene.spec.files->add("w.json"), 7};
    row.scene.wall(5, -1, 6, 1);
    change(row);
    for (InterventionSpec& each : row.scene.spec.experiment.at) each.where = where;
    for (FaultSpec& each : row.scene.spec.experiment.faults) each.where = where;
    return row.errors();
  };
  const auto doing = [&](InterventionSpec spec) {
    return errors([&](Squad& row) { row.scene.spec.experiment.at = {spec}; });
  };
  EXPECT_THAT(doing(at(1, Action::remove, population("rs"))),
              HasSubstr("w.json:7: error: /at/0: unknown population \"rs\"; known: r"));
  EXPECT_THAT(errors([&](Squad& row) {
                row.scene.body("70", row.type, {3, 3, 0, 0});
                row.scene.spec.experiment.at = {at(1, Action::remove, population("q"))};
              }),
              HasSubstr("unknown population \"q\"; known: r"))
      << "the population of 70 is unknown";
  EXPECT_THAT(doing(at(1, Action::disable, {By::type, "bto", {}, {}})),
              HasSubstr("unknown type \"bto\"; known: bot (did you mean \"bot\"?)"));
  EXPECT_THAT(doing(at(1, Action::enable, model("r9"))),
              HasSubstr("unknown model \"r9\"; known: r0, r1, r2"));
  EXPECT_THAT(doing(at(1, Action::remove, model("wall4"))),
              HasSubstr("\"wall4\" is a static body: interventions and faults can only act on bodies that"));
  EXPECT_THAT(
      doing(at(1, Action::remove, population("wall"))),
      HasSubstr("/at/0: the bodies of the population \"wall\" are static: interventions and faults can"));
  EXPECT_THAT(errors([&](Squad& row) {
                row.scene.body("post", row.scene.type("pole", {box(0.1, 0.1)}), {3, 3, 0, 0});
                row.scene.spec.experiment.at = {at(1, Action::remove, {By::type, "pole", {}, {}})};
              }),
              HasSubstr("/at/0: the bodies of the type \"pole\" are static: interventions and faults can"));
  EXPECT_THAT(
      doing(at(1.5, Action::add, population("r"))),
      HasSubstr("w.json:7: error: /at/0: at 1.5 s: no body can be added to \"r\": no population has a "
                "\"reserve\"; give this population a \"reserve\""));
  InterventionSpec outside = at(1, Action::move, model("r0"));
  outside.pose = Pose{1e6, 0, 0, 0};
  EXPECT_THAT(doing(outside),
              HasSubstr("\"r0\" would be moved to x 1000000, y 0 (m), outside the world's bounds ("));
  const auto adding = [&](const std::optional<Pose>& pose, const std::optional<Box>& region) {
    return errors([&](Squad& row) {
      row.scene.spec.bounds = Box::around(Vec2(0, 0), 10);
      row.scene.spec.reserves.push_back({"more", BodyId(row.scene.spec.bodies.size()), 1});
      row.scene.body("more0", row.type);
      InterventionSpec& add =
          row.scene.spec.experiment.at.emplace_back(at(1, Action::add, population("more")));
      add.pose = pose;
      add.region = region;
    });
  };
  EXPECT_THAT(adding(Pose{50, 0, 0, 0}, {}),
              HasSubstr("w.json:7: error: /at/0: at 1 s: a body of \"more\" would be added at x 50, y 0 (m), "
                        "outside the world's bounds (x -10 to 10, y -10 to 10 m)"));
  EXPECT_THAT(adding({}, Box::around(Vec2(12, 0), 1)),
              HasSubstr("w.json:7: error: /at/0: at 1 s: \"region_m\", in which bodies of \"more\" would be "
                        "added, is outside the world's bounds (x -10 to 10, y -10 to 10 m)"));
  EXPECT_EQ(adding({}, Box::around(Vec2(10, 0), 1)), "no error") << "partly inside";
  const FieldTable& drive = test::registry().drive("diff")->params;
  EXPECT_THAT(
      doing(setting(1, TypeId(1), SettingSpec::Of::drive, drive, "velocity_max_x", -2.0)),
      HasSubstr("drive \"diff\": velocity_min_x, velocity_max_x: lower bound -1 exceeds upper bound -2"));
  EXPECT_THAT(doing(setting(1, TypeId(1), SettingSpec::Of::drive, drive, "localization", "odom")),
              HasSubstr("\"localization\" cannot change while the world runs"));
  EXPECT_THAT(doing(setting(1, TypeId(1), SettingSpec::Of::drive, drive, "pushes", 2)),
              HasSubstr("\"pushes\" cannot change while the world runs"));
  const FieldTable& ranger = test::registry().device("ranger")->params;
  EXPECT_THAT(doing(setting(1, TypeId(1), SettingSpec::Of::device, ranger, "transducers",
                            get(ranger, test::ranger("eye", {{.samples = 3}}).params, "transducers"))),
              HasSubstr("device \"eye\": \"set\" cannot change a parameter that determines how many values a "
                        "device reads or stores, where its beams start or point, the size of its solids, "
                        "how far its joints move, how many effects it can have on other bodies, or which "
                        "devices a controller uses"));
  const FieldTable& gripper = test::registry().device("gripper")->params;
  for (const char* name : {"size", "paddle_size"}) {
    SCOPED_TRACE(name);
    Squad row(1);
    test::add_device(row.scene[row.type], "hand", "gripper", {0.3, 0, 0, 0});
    std::vector<double> larger = get(gripper, gripper.defaults(), name).numbers();
    larger[2] *= 1.25;  // its y would also change how far the joints move
    InterventionSpec set = setting(1, row.type, SettingSpec::Of::device, gripper, name, larger);
    set.setting->index = static_cast<std::uint32_t>(row.scene[row.type].devices.size() - 1);
    row.scene.spec.experiment.at = {set};
    EXPECT_THAT(row.errors(), HasSubstr("the size of its solids"));
  }

  const auto failing = [&](FaultSpec spec) {
    return errors([&](Squad& row) { row.scene.spec.experiment.faults = {spec}; });
  };
  EXPECT_THAT(
      failing(fault(population("r"), 0, "dead_sensors", {{"sensors", "eye, ear"}})),
      HasSubstr("w.json:7: error: /faults/0: fault \"dead_sensors\": unknown sensor of type \"bot\" \"ear\"; "
                "known: eye"));
  EXPECT_THAT(failing(fault(population("q"), 0, "drop_out", {{"rate", 1.0}})),
              HasSubstr("error: /faults/0: unknown population \"q\"; known: r"));
}

TEST(Experiment, AFaultThatABodyCannotHaveIsAnError) {
  const auto failing = [](auto&& change, const FaultSpec& spec) {
    Squad row(1);
    change(row.scene[row.type]);
    row.scene.spec.experiment.faults = {spec};
    return row.errors();
  };
  const FaultSpec dead = fault(population("r"), 0, "dead_sensors", {});
  EXPECT_THAT(failing([](TypeSpec& type) { type.devices.clear(); }, dead),
              HasSubstr("fault \"dead_sensors\": this fault needs a sensor, but bodies of type \"bot\" have "
                        "none"));
  const auto add_many = [](TypeSpec& type) {
    while (type.devices.size() < 33)
      type.devices.push_back(test::ranger(fmt::format("eye{}", type.devices.size()), {{.range_max = 5}}));
  };
  EXPECT_THAT(
      failing(add_many, dead),
      HasSubstr("fault \"dead_sensors\": \"eye32\" is device 33 of type \"bot\" (counted from 1), but "
                "faults can only concern the first 32: move it up in the list of sensors"));
  EXPECT_THAT(
      failing([](TypeSpec& type) { type.drive.reset(); },
              fault(population("r"), 0, "slow_wheels", {{"factor", 0.5}})),
      HasSubstr("fault \"slow_wheels\": this fault needs a drive, but bodies of type \"bot\" have none"));
}

TEST(Experiment, AProgramSetsNothingThatALaterSettingContradicts) {
  Squad row(1);
  const FieldTable& drive = test::registry().drive("diff")->params;
  row.scene.spec.experiment.at = {
      setting(0.5, row.type, SettingSpec::Of::drive, drive, "velocity_max_x", 0.25)};
  const auto world = row.world();
  const auto set_least = [&](double speed) {
    const InterventionSpec least =
        setting(0, row.type, SettingSpec::Of::drive, drive, "velocity_min_x", speed);
    const Result<> done = world->set(*least.setting, test::registry());
    return done ? "done" : done.error().text;
  };
  EXPECT_EQ(set_least(0.5),
            "with these values, the world's intervention \"set\" at 0.5 s would fail: drive \"diff\": "
            "velocity_min_x, velocity_max_x: lower bound 0.5 exceeds upper bound 0.25");
  EXPECT_EQ(set_least(0.125), "done");
}

// If each of these interventions searched all names, this would take minutes.
TEST(Experiment, AnUnknownGroupOfManyInterventionsIsSoughtOnce) {
  Squad row(test::k_slow_build ? 2'000 : 200'000);
  row.scene.spec.experiment.at.assign(900, at(1, Action::remove, model("q")));
  EXPECT_THAT(row.errors(), HasSubstr("\n... and 850 more errors"));
}

/// A kind of fault that returns `made`, and its error when a world is built.
struct AnyFault {
  static inline Impairment made;

  static std::string error(const Impairment& impairment) {
    made = impairment;
    return error_of([](const Record&, const BodyType&) { return Result<Impairment>(made); });
  }
  static std::string error_of(Result<Impairment> (*prepare)(const Record&, const BodyType&)) {
    Registry registry = test::registry();
    registry.faults.push_back({"any", "", {}, prepare});
    Squad row(2);
    row.scene.spec.files = std::make_shared<SourceFiles>();
    const Where where{row.scene.spec.files->add("w.json"), 7};
    row.scene.spec.experiment.faults = {{population("r"), 0, {{"any", {}}}, where}};
    Diagnostics diagnostics(row.scene.spec.files);
    try {
      World(row.scene.spec, registry, {.threads = 1}, diagnostics);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST(Experiment, AFaultOutOfItsRangeIsAnError) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(AnyFault::error({.speed = 0.5, .drops_out = true, .per_s = 1, .lasts_s = 2}), "no error");
  EXPECT_EQ(
      AnyFault::error({.speed = 2}),
      "w.json:7: error: /faults/0: fault \"any\" has the factor 2 on the velocity (Impairment::speed): it "
      "must be above 0 and at most 1");
  for (const double speed : {0.0, -1.0, k_nan})
    EXPECT_THAT(AnyFault::error({.speed = speed}), HasSubstr("(Impairment::speed)"));
  EXPECT_THAT(AnyFault::error({.per_s = -1}),
              HasSubstr("fault \"any\" occurs at the rate -1 1/s (Impairment::per_s): this must be a finite "
                        "number of at least 0"));
  EXPECT_THAT(AnyFault::error({.lasts_s = -1}), HasSubstr("fault \"any\" lasts -1 s (Impairment::lasts_s)"));
  for (const double wrong : {k_nan, k_infinity}) {
    EXPECT_THAT(AnyFault::error({.per_s = wrong}), HasSubstr("(Impairment::per_s)"));
    EXPECT_THAT(AnyFault::error({.lasts_s = wrong}), HasSubstr("(Impairment::lasts_s)"));
  }
}

TEST(Experiment, AnExceptionOfAFaultIsAnErrorThatNamesIt) {
  EXPECT_EQ(AnyFault::error_of([](const Record&, const BodyType&) -> Result<Impairment> {
              throw std::runtime_error("not today");
            }),
            "w.json:7: error: /faults/0: fault \"any\" threw: not today");
}

/// What loading a world says if its robots have this device and an intervention sets one of its parameters.
std::string error_of_setting(std::string_view kind, Record params, std::string_view name, Value value) {
  Squad row(1);
  const FieldTable& table = test::registry().device(kind)->params;
  row.scene[row.type].devices = {{.name = "d", .kind = std::string(kind), .params = std::move(params)}};
  row.scene.spec.experiment.at = {
      setting(1, row.type, SettingSpec::Of::device, table, name, std::move(value))};
  return row.errors();
}

TEST(Experiment, TheCapacityOfAPowerPackIsNotSet) {
  const Record pack = test::record(test::registry().device("power_pack")->params, {{"capacity", 2.0}});
  EXPECT_THAT(
      error_of_setting("power_pack", pack, "capacity", 500.0),
      HasSubstr("device \"d\": \"capacity\" cannot change while the world runs; give it in the type"));
  EXPECT_THAT(error_of_setting("power_pack", pack, "infinite", true),
              HasSubstr("device \"d\": \"infinite\" cannot change while the world runs"));
  EXPECT_EQ(error_of_setting("power_pack", pack, "capacity", 2.0), "no error") << "it does not change";
  EXPECT_EQ(error_of_setting("power_pack", pack, "draw", 3.0), "no error");
}

TEST(Experiment, AnExceptionOfTheBodyOfADeviceNamesTheDevice) {
  Registry registry = test::registry();
  DeviceKind kind = *registry.device("power_pack");
  kind.name = "crane";
  kind.body = [](const Record& params) -> std::vector<DeviceKind::Fixture> {
    if (params != test::record(test::registry().device("power_pack")->params, {}))
      throw std::runtime_error("bent");
    return {};
  };
  registry.devices.push_back(kind);
  Squad row(1);
  row.scene[row.type].devices = {{.name = "d", .kind = "crane", .params = test::record(kind.params, {})}};
  row.scene.spec.experiment.at = {setting(1, row.type, SettingSpec::Of::device, kind.params, "draw", 2.0)};
  Diagnostics diagnostics;
  EXPECT_THAT([&] { World(row.scene.spec, registry, {.threads = 1}, diagnostics); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("device \"d\" (crane) threw: bent")));
}

/// Expects that interventions and faults for a group without bodies are no errors and have no effect.
void expect_no_effect(Squad& row, const GroupSpec& idle) {
  row.scene.spec.experiment.at = {at(0.1, Action::disable, idle), at(0.2, Action::remove, idle),
                                  at(0.3, Action::move, idle)};
  row.scene.spec.experiment.at.back().pose = Pose{1, 1, 0, 0};
  row.scene.spec.experiment.faults = {fault(idle, 0, "slow_wheels", {{"factor", 0.5}})};
  ASSERT_EQ(row.errors(), "no error");
  const auto world = row.world();
  step(*world, 5);
  EXPECT_THAT(there(*world), ElementsAre("r0", "r1"));
  EXPECT_NEAR(x_of(*world, "r1"), 0.5, 1e-9) << "the entries have no effect";
}

TEST(Experiment, ATypeMayHaveNoBodies) {
  Squad row(2);
  row.scene.robot("idle", {box(0.4, 0.4)});
  expect_no_effect(row, {By::type, "idle", {}, {}});
}

TEST(Experiment, APopulationMayHaveNoBodies) {
  Squad row(2);
  row.scene.spec.empty_populations = {{"idle", row.scene.spec.bodies.back().type}};
  expect_no_effect(row, {By::population, "idle", {}, {}});
}

// ---- determinism

/// A crowd to which everything happens that can.
class Trial {
 public:
  static constexpr int k_ticks = test::k_slow_build ? 25 : 60;

  explicit Trial(const WorldOptions& options) {
    const TypeId type = scene_.robot("bot", {box(0.3, 0.3, 0.3)}, "omni");
    scene_[type].devices = {test::ranger("eye", {{.range_max = 2}}), test::ranger("ear", {{.range_max = 1}})};
    for (int i = 0; i < 60; ++i)
      scene_.body(fmt::format("r{}", i), type, {0.5 * (i % 10), 0.5 * (i / 10), 0, 0});
    scene_.spec.reserves.push_back({"more", BodyId(scene_.spec.bodies.size()), 40});
    for (int i = 0; i < 40; ++i) scene_.body(fmt::format("more{}", i), type);
    scene_.spec.bounds = Box::around(Vec2(2, 1), 6);
    ExperimentSpec& e = scene_.spec.experiment;
    InterventionSpec move = at(1.2, Action::move, model("r7"));
    move.pose = Pose{-3, -3, 0, 1};
    e.at = {at(0.4, Action::remove, population("r", 10)),
            at(0.8, Action::add, population("more", 20)),
            at(1.0, Action::disable, {By::type, "bot", {}, 0.3}),
            move,
            at(1.6, Action::enable, {By::type, "bot", {}, 0.5}),
            setting(2, type, SettingSpec::Of::drive, test::registry().drive("omni")->params, "velocity_max_x",
                    0.3),
            at(2.2, Action::add, population("more"))};
    e.faults = {fault(population("r", {}, 0.3), 0.2, "slow_wheels", {{"factor", 0.4}}),
                fault(population("r", 9), 0.3, "dead_sensors", {{"sensors", "ear"}}),
                fault({By::type, "bot", {}, {}}, 0, "drop_out", {{"rate", 0.5}, {"for", 0.3}})};
    Diagnostics diagnostics;
    world_ = std::make_unique<World>(scene_.spec, test::registry(), options, diagnostics);
  }
  World& world() { return *world_; }
  void step() {
    for (std::size_t r = 0; r < world_->view().rows(); ++r) {
      const Row row(r);
      if (!world_->view().is_there(row)) continue;
      Random random(7, 1, world_->view().body(row).value, static_cast<std::uint32_t>(world_->tick()));
      world_->set_command(row, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    }
    world_->step();
  }
  std::vector<std::uint64_t> run(int ticks) {
    std::vector<std::uint64_t> hashes{world_->hashes().state};
    for (int tick = 0; tick < ticks; ++tick) {
      step();
      hashes.push_back(world_->hashes().state);
    }
    return hashes;
  }

 private:
  SceneBuilder scene_;
  std::unique_ptr<World> world_;
};

TEST(Experiment, IsTheSameOnAnyThreadsAndTilesAndAfterAReset) {
  Trial first({.threads = 1});
  const auto expected = first.run(Trial::k_ticks);
  EXPECT_GT(test::count_impaired(first.world()), 10u);
  EXPECT_EQ(first.world().robots(), 60u - 10 + 40);
  EXPECT_EQ(Trial({.threads = 2, .tile_size_m = 0.9}).run(Trial::k_ticks), expected);
  EXPECT_EQ(Trial({.threads = 8, .tile_size_m = 30}).run(Trial::k_ticks), expected);
  first.world().reset();
  EXPECT_EQ(test::count_impaired(first.world()), 0u);
  EXPECT_EQ(first.run(Trial::k_ticks), expected) << "after a reset";
}

TEST(Experiment, GoesOnFromTheMiddleOfIt) {
  for (const int middle : {3, 10, 17, 21}) {
    Trial straight({.threads = 1});
    straight.run(middle);
    World& world = straight.world();
    const std::vector<StateTable> saved(world.tables().begin(), world.tables().end());
    const std::uint64_t tick = world.tick();
    const World::Counters counters = world.counters();
    const std::uint64_t hash = world.hashes().state;
    const auto expected = straight.run(Trial::k_ticks - middle);

    Trial other({.threads = 2});
    other.run(test::k_slow_build ? 0 : 40);  // has been elsewhere
    ASSERT_TRUE(other.world().restore(tick, counters, hash, [&](std::span<StateTable> into) {
      for (std::size_t t = 0; t < saved.size(); ++t) into[t] = saved[t];
    }));
    EXPECT_EQ(other.run(Trial::k_ticks - middle), expected) << "from tick " << middle;
  }
}

TEST(Experiment, AStateThatCannotHaveComeAboutIsRefused) {
  Trial trial({.threads = 1});
  trial.run(15);
  World& world = trial.world();
  const std::vector<StateTable> saved(world.tables().begin(), world.tables().end());
  const World::Counters counters = world.counters();
  const auto restored = [&](auto&& change) {
    std::uint64_t hash = 0;
    std::vector<StateTable> tables = saved;
    for (StateTable& table : tables)
      if (table.component() == "condition") change(table.as<Condition>(0));
    for (StateTable& table : tables) hash += table.hash_rows(0, table.rows());
    return world.restore(15, counters, hash, [&](std::span<StateTable> into) {
      for (std::size_t t = 0; t < tables.size(); ++t) into[t] = tables[t];
    });
  };
  EXPECT_TRUE(restored([](Condition&) {}));
  EXPECT_FALSE(restored([](Condition& now) { now.speed = 2; }));
  EXPECT_FALSE(restored([](Condition& now) { now.speed = std::nan(""); }));
  EXPECT_FALSE(restored([](Condition& now) { now.out = 4; }));
}

TEST(Experiment, AWorldWithoutOneHasNoSuchComponent) {
  Squad row(2);
  const auto plain = row.world();
  const auto has_conditions = [](const World& world) {
    return std::ranges::any_of(world.tables(),
                               [](const StateTable& table) { return table.component() == "condition"; });
  };
  EXPECT_FALSE(has_conditions(*plain));
  EXPECT_EQ(
      test::message_of<std::logic_error>([&] { plain->set_disabled(Row(0), true); }),
      "programs cannot disable \"r0\": add \"mortal\": true to the world file, or set this key when you "
      "load the world (in C++: SimulationOptions::mortal; in Python: set={\"/mortal\": True}); worlds "
      "with faults, or with an intervention \"disable\" or \"enable\", need neither");
  step(*plain, 3);
  row.scene.spec.experiment.faults = {fault(population("r"), 9, "drop_out", {{"rate", 1.0}})};
  const auto world = row.world();
  EXPECT_TRUE(has_conditions(*world));
  step(*world, 3);
  EXPECT_EQ(world->hashes().state, plain->hashes().state) << "faults add nothing before they occur";
}

// ---- the end

TEST(StopConditions, TheFirstThatHoldsIsToldAfterItsTick) {
  EXPECT_TRUE(holds(1, Comparison::at_least, 1));
  EXPECT_FALSE(holds(1, Comparison::above, 1));
  EXPECT_TRUE(holds(1, Comparison::at_most, 1));
  EXPECT_FALSE(holds(1, Comparison::below, 1));
  EXPECT_TRUE(holds(1, Comparison::equal, 1));
  EXPECT_TRUE(holds(1, Comparison::unequal, 2));
  EXPECT_FALSE(holds(std::nan(""), Comparison::unequal, 2)) << "no number is nothing";

  Squad row(3);
  row.scene.spec.experiment.at = {at(1, Action::remove, population("r", 2))};
  const auto world = row.world();
  const auto on = [](std::string kind, Comparison comparison, double value) {
    return StopSpec{{std::move(kind), "", "", {}, {}}, comparison, value};
  };
  const std::vector<StopSpec> conditions{on("displacement", Comparison::at_least, 2),
                                         on("alive", Comparison::below, 2),
                                         on("alive", Comparison::equal, 0)};
  EXPECT_EQ(text_of(conditions[0]), "displacement >= 2");
  Diagnostics diagnostics;
  StopConditions stop(*world, test::registry(), conditions, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  for (int tick = 1; tick <= 10; ++tick) {
    world->step();
    stop.see();
    EXPECT_FALSE(stop.holding()) << tick;
  }
  world->step();
  stop.see();
  EXPECT_EQ(stop.holding(), 1u);
  step(*world, 1);  // measures begin again where ticks are missed, and say what is
  for (int tick = 0; tick < 9; ++tick) {
    world->step();
    stop.see();
  }
  EXPECT_EQ(stop.holding(), 0u) << "2 m at tick 20, and the first of those that hold is told";
  world->reset();
  stop.begin();
  EXPECT_FALSE(stop.holding());
}

}  // namespace
}  // namespace troupe::engine::experiment_test
