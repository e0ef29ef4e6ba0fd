#include "models/devices/flags.hpp"

#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe::models::flags_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;

engine::DeviceSpec flags(int most, int yellow = 0) {
  return {
      .name = "flags",
      .kind = "flags",
      .params = test::record(test::registry().device("flags")->params, {{"most", most}, {"yellow", yellow}})};
}

/// A holder, in reach of a program: commands as a controller gives them.
struct Holder {
  World& world;
  BodyId body;

  const engine::BodyType::Device& device() const {
    for (const engine::BodyType::Device& d : world.view().type(world.view().row(body)).devices)
      if (d.kind->name == "flags") return d;
    throw std::out_of_range("no flags");
  }
  std::size_t slot() const { return world.view().slot(world.view().row(body)); }
  std::uint32_t count() const {
    return world.tables()[device().table].cell<std::uint32_t>(slot(), k_flag_count)[0];
  }
  std::uint64_t received() const {
    return world.tables()[device().table].cell<std::uint64_t>(slot(), k_flag_received)[0];
  }
  std::vector<std::uint32_t> colors() const {
    const auto all = world.tables()[device().table].cell<std::uint32_t>(slot(), k_flag_colors);
    return {all.begin(), all.begin() + count()};
  }
};

/// Asks for what its parameters say, once, in the first tick.
struct Asker {
  static constexpr bool needs_drive = false;
  struct Params {
    std::uint8_t verb = 0;
    std::uint32_t target = 0;
    std::uint32_t color = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::verb>("verb");
      d.member<&Params::target>("target");
      d.member<&Params::color>("color");
    }
  };

  Params params;

  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) { return {0}; }
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    if (percept.tick != 1) return;
    const auto verb = static_cast<FlagCommand::Verb>(params.verb);
    actions.device<FlagCommand>(0).ask(verb, params.target, {params.color, 0.1f});
  }
};

const engine::Registry& registry_with_asker() {
  static const engine::Registry registry = [] {
    engine::Registry kinds = make_registry();
    kinds.controllers.push_back(engine::make_controller_kind<Asker>("asker", ""));
    return kinds;
  }();
  return registry;
}

/// Bodies that hold flags; those with a verb ask for it in the first tick.
struct Crowd {
  SceneBuilder scene;
  BodyId add(int most, int yellow, FlagCommand::Verb verb = FlagCommand::nothing, std::uint32_t target = 0,
             int color = 0) {
    const auto n = scene.spec.bodies.size();
    const TypeId type = scene.type("t" + std::to_string(n), {box(0.2, 0.2)});
    scene[type].devices = {flags(most, yellow)};
    if (verb != FlagCommand::nothing)
      scene[type].controllers = {
          {.kind = "asker", .params = {int{verb}, static_cast<int>(target), color}, .where = {}}};
    return scene.body("b" + std::to_string(n), type, {static_cast<double>(n), 0, 0, 0});
  }
  World world() {
    Diagnostics diagnostics;
    return {scene.spec, registry_with_asker(), {.threads = 2}, diagnostics};
  }
};

TEST(Flags, ArePushedToTheFrontAndPoppedOnceForEachRequest) {
  Crowd crowd;
  const BodyId pusher = crowd.add(3, 1, FlagCommand::push, 0, 7);
  const BodyId full = crowd.add(2, 2, FlagCommand::push, 0, 7);
  const BodyId popper = crowd.add(3, 2, FlagCommand::pop);
  const BodyId empty = crowd.add(3, 0, FlagCommand::pop);
  World world = crowd.world();
  world.step();
  EXPECT_EQ((Holder{world, pusher}.count()), 1);  // asked for in this tick, done in the next
  for (int t = 0; t < 3; ++t) world.step();
  EXPECT_THAT((Holder{world, pusher}.colors()), testing::ElementsAre(7, k_yellow_flag.color));
  EXPECT_THAT((Holder{world, full}.colors()), testing::ElementsAre(k_yellow_flag.color, k_yellow_flag.color));
  EXPECT_EQ((Holder{world, popper}.count()), 1);
  EXPECT_EQ((Holder{world, empty}.count()), 0);
}

TEST(Flags, ChangeHandsAndNoneIsLost) {
  Crowd crowd;
  const BodyId store = crowd.add(8, 2);
  std::vector<BodyId> takers;
  for (int i = 0; i < 4; ++i) takers.push_back(crowd.add(2, 0, FlagCommand::take, store.value));
  const BodyId giver = crowd.add(2, 1, FlagCommand::give, takers[3].value);
  const BodyId full = crowd.add(1, 1, FlagCommand::take, store.value);
  const BodyId from_no_body = crowd.add(2, 1, FlagCommand::give, 0);  // the ground
  const BodyId to_no_id = crowd.add(2, 1, FlagCommand::give, 999'999);
  const BodyId of_no_id = crowd.add(2, 1, FlagCommand::take, 2'147'483'647);
  World world = crowd.world();
  for (int t = 0; t < 4; ++t) world.step();
  EXPECT_EQ((Holder{world, store}.count()), 0);
  EXPECT_EQ((Holder{world, takers[0]}.count()), 1);  // the two lowest ids
  EXPECT_EQ((Holder{world, takers[1]}.count()), 1);
  EXPECT_EQ((Holder{world, takers[2]}.count()), 0);
  EXPECT_EQ((Holder{world, takers[3]}.count()), 1);
  EXPECT_EQ((Holder{world, takers[3]}.received()), 1);
  EXPECT_EQ((Holder{world, giver}.count()), 0);
  EXPECT_EQ((Holder{world, full}.count()), 1);
  for (const BodyId unserved : {from_no_body, to_no_id, of_no_id})
    EXPECT_EQ((Holder{world, unserved}.count()), 1);
}

TEST(Flags, MoreAtTheStartThanTheListHoldsIsAnError) {
  Crowd crowd;
  crowd.add(2, 3);
  EXPECT_THAT(test::message_of<InputError>([&] { crowd.world(); }),
              testing::HasSubstr("has 3 flags at the start (\"yellow\"), but its list holds at "
                                 "most 2: give a larger \"most\""));
}

TEST(Depots, ASourceFillsUpAndASinkCountsAndEmpties) {
  SceneBuilder scene;
  const TypeId source_type = scene.type("source", {box(1, 1)});
  scene[source_type].devices = {flags(16)};
  scene[source_type].controllers = {test::controller("source", {{"capacity", 3}})};
  const BodyId source = scene.body("source", source_type);
  const TypeId sink_type = scene.type("sink", {box(1, 1)});
  scene[sink_type].devices = {flags(16, 5)};
  scene[sink_type].controllers = {test::controller("sink")};
  const BodyId sink = scene.body("sink", sink_type, {3, 0, 0, 0});
  World world = scene.world();
  for (int t = 0; t < 3; ++t) world.step();
  EXPECT_EQ((Holder{world, source}.count()), 2);
  EXPECT_EQ((Holder{world, sink}.count()), 3);
  for (int t = 0; t < 9; ++t) world.step();
  EXPECT_EQ((Holder{world, source}.count()), 3);
  EXPECT_EQ((Holder{world, sink}.count()), 0);
}

}  // namespace
}  // namespace troupe::models::flags_test
