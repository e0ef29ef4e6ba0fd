#include "engine/observing/events.hpp"

#include "tests/engine/conflict_crowds.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/scene.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace troupe::engine::events_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> texts(const World& world, std::span<const Event> events) {
  std::vector<std::string> lines;
  for (const Event& event : events)
    lines.push_back(fmt::format("{} {}", event_name(event.type), world.spec().name(event.body)));
  return lines;
}

TEST(Events, KindsStandInTheOrderOfTheirTypes) {
  for (std::size_t i = 0; i < event_kinds().size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(event_kinds()[i].type), i);
}

TEST(Events, StallsBeginAndEndAndRobotsAreHeldAtTheBounds) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
  scene.wall(1, -1, 1.1, 1);
  scene.body("up", bot, {0.3, 1.6, 0, 0});
  scene.body("right", bot, {0.75, 0, 0, 0});
  scene.spec.bounds = Box::around(Vec2::Zero(), 1.75);
  World world = scene.world();
  EventWatch watch(world);
  EXPECT_THAT(watch.see(world), IsEmpty());
  const Row up = world.view().row(world.state().names.find("up"));
  const Row right = world.view().row(world.state().names.find("right"));
  world.set_command(up, {0, 1, 0});
  world.set_command(right, {1, 0, 0});
  const auto next = [&] {
    world.step();
    return texts(world, watch.see(world));
  };
  EXPECT_THAT(next(), IsEmpty());  // to 1.7 and 0.85
  EXPECT_THAT(next(), ElementsAre("held_begins up", "stall_begins right"));
  EXPECT_THAT(next(), IsEmpty());
  world.set_command(up, {0, 0, 0});
  world.set_command(right, {-1, 0, 0});
  EXPECT_THAT(next(), ElementsAre("held_ends up", "stall_ends right"));
  EXPECT_THAT(next(), IsEmpty());
}

TEST(Events, AStallEndsWithTheDeathOfTheRobot) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
  scene.wall(1, -1, 1.1, 1);
  scene.body("bot", bot, {0.85, 0, 0, 0});
  scene.spec.mortal = true;
  World world = scene.world();
  EventWatch watch(world);
  world.set_command(Row(0), {1, 0, 0});
  world.step();
  EXPECT_THAT(texts(world, watch.see(world)), ElementsAre("stall_begins bot"));
  world.remove(Row(0));
  world.step();
  EXPECT_THAT(texts(world, watch.see(world)), ElementsAre("stall_ends bot", "death bot"));
}

TEST(Events, AHeldRobotThatIsRefusedEndsTheOneAndBeginsTheOther) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
  scene.wall(1, -1, 1.1, 1);
  scene.body("bot", bot, {0.85, 0.95, 0, 0});
  scene.spec.bounds = Box::around(Vec2::Zero(), 1);
  World world = scene.world();
  EventWatch watch(world);
  world.set_command(Row(0), {0, 1, 0});
  world.step();
  EXPECT_THAT(texts(world, watch.see(world)), ElementsAre("held_begins bot"));
  world.set_command(Row(0), {0.8, 0, 0});
  world.step();
  EXPECT_THAT(texts(world, watch.see(world)), ElementsAre("held_ends bot", "stall_begins bot"));
}

/// What the table of stalls says of each body.
std::map<std::uint32_t, int> stalls_of(const World& world) {
  std::map<std::uint32_t, int> stalls;
  for (const StateTable& table : world.tables())
    if (table.component() == "stall")
      for (std::size_t r = 0; r < table.rows(); ++r)
        stalls[table.ids()[r].value] = table.cell<std::uint8_t>(r, 0)[0];
  return stalls;
}

/// Robots that jostle in a pen, commanded at random.
class Enclosure {
 public:
  explicit Enclosure(unsigned threads) {
    test::SceneBuilder scene;
    const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.3, 0.2)}, {0, 0.3}}}, "omni");
    for (int i = 0; i < 40; ++i)
      scene.body(fmt::format("r{}", i), bot, {0.35 * (i % 7), 0.3 * (i / 7), 0, 0});
    scene.spec.bounds.emplace();
    scene.spec.bounds->extend(Vec2(-0.1, -0.1));
    scene.spec.bounds->extend(Vec2(2.4, 2.4));
    Diagnostics diagnostics;
    world_ =
        std::make_unique<World>(scene.spec, test::registry(), WorldOptions{.threads = threads}, diagnostics);
  }
  World& world() { return *world_; }
  void step() {
    for (std::size_t b = 1; b < world_->spec().bodies.size(); ++b)
      if (draw_.chance(0.5))
        world_->set_command(world_->view().row(BodyId(b)),
                            {draw_.real(-1, 1), draw_.real(-1, 1), draw_.real(-1, 1)});
    world_->step();
  }

 private:
  std::unique_ptr<World> world_;
  oracle::Draw draw_{3};
};

TEST(Events, AreTheChangesOfTheTableOfStallsByIdWhateverTheThreads) {
  std::vector<std::vector<std::string>> runs;
  for (const unsigned threads : {1u, 3u}) {
    Enclosure enclosure(threads);
    EventWatch watch(enclosure.world());
    std::map<std::uint32_t, int> before = stalls_of(enclosure.world());
    std::vector<std::string> run;
    for (int tick = 0; tick < 60; ++tick) {
      enclosure.step();
      const std::map<std::uint32_t, int> now = stalls_of(enclosure.world());
      std::vector<std::string> expected;
      for (const auto& [body, stall] : now) {
        const std::string name = enclosure.world().spec().name(BodyId(body));
        if (stall == before[body]) continue;
        if (before[body] == 1) expected.push_back("stall_ends " + name);
        if (before[body] == 2) expected.push_back("held_ends " + name);
        if (stall == 1) expected.push_back("stall_begins " + name);
        if (stall == 2) expected.push_back("held_begins " + name);
      }
      EXPECT_EQ(texts(enclosure.world(), watch.see(enclosure.world())), expected) << tick;
      run.insert(run.end(), expected.begin(), expected.end());
      before = now;
    }
    for (const EventType type :
         {EventType::stall_ends, EventType::held_ends, EventType::stall_begins, EventType::held_begins}) {
      const std::string name(event_name(type));
      EXPECT_THAT(run, ::testing::Contains(::testing::StartsWith(name))) << name;
    }
    runs.push_back(run);
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(Events, GripsAndReleasesAreThoseOfTheCarrier) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.4, 0.4, 0.3)});
  test::add_device(scene[bot], "hand", "gripper", {0.3, 0, 0, 0});
  scene[bot].controllers.push_back(
      test::operate({test::order(0.1, "hand", "close"), test::order(2, "hand", "open")}));
  const TypeId puck = scene.type("puck", {test::box(0.1, 0.1, 0.1)}, {.gripper = true});
  scene.body("p", puck, {0.34, 0, 0, 0});
  const BodyId robot = scene.body("r", bot);
  World world = scene.world();
  EventWatch watch(world);
  std::vector<std::string> lines;
  for (int t = 0; t < 40; ++t) {
    world.step();
    for (const Event& event : watch.see(world)) {
      ASSERT_TRUE(event.other.valid());
      EXPECT_EQ(event.body, robot);
      lines.push_back(fmt::format("{} {} {}", event_name(event.type), world.spec().name(event.body),
                                  world.spec().name(event.other)));
    }
  }
  EXPECT_THAT(lines, ElementsAre("grip r p", "release r p"));
}

TEST(Events, AWatchMayBeginWithAnyTickAndTellsNothingOfAReset) {
  Enclosure enclosure(2);
  EventWatch first(enclosure.world());
  for (int tick = 0; tick < 5; ++tick) {
    enclosure.step();
    first.see(enclosure.world());
  }
  EventWatch second(enclosure.world());
  enclosure.step();
  EXPECT_EQ(texts(enclosure.world(), second.see(enclosure.world())),
            texts(enclosure.world(), first.see(enclosure.world())));
  enclosure.world().reset();
  EXPECT_THAT(first.see(enclosure.world()), IsEmpty());
}

}  // namespace
}  // namespace troupe::engine::events_test
