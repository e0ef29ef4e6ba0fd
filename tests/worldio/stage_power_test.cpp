#include "tests/worldio/stage_fixture.hpp"

#include <string>

namespace troupe::worldio::stage_power_test {
namespace {

using engine::DeviceSpec;
using engine::TypeSpec;
using testing::ElementsAre;
using testing::HasSubstr;

/// Energy, as the properties of Stage's models give it.
class StagePowerTest : public StageTest {
 protected:
  /// The devices of the first body of a file.
  std::vector<DeviceSpec> devices(const std::string& text) {
    const engine::WorldSpec spec = load(text);
    return spec.types[spec.bodies.at(1).type.index()].devices;
  }
  static double number(const DeviceSpec& device, std::string_view field) {
    return engine::get(test_registry().device(device.kind)->params, device.params, field).number();
  }
  static bool infinite(const DeviceSpec& device) {
    return engine::get(test_registry().device(device.kind)->params, device.params, "infinite").boolean();
  }
};

TEST_F(StagePowerTest, JoulesAreStoredAndCapacityInTheOrderInWhichStageReadsThem) {
  struct Case {
    const char* text;
    double stored, capacity;
  };
  for (const Case& c : {Case{"joules 50", 50, 50},
                        {"kjoules 2", 2000, 2000},
                        {"joules_capacity 80", 0, 80},
                        {"joules 50 joules_capacity 80", 50, 80},
                        {"joules_capacity 30 joules 50", 30, 30},
                        {"kjoules_capacity 1 joules 50", 50, 1000},
                        {"kjoules 2 joules 50", 2000, 2000}}) {
    const std::vector<DeviceSpec> found = devices(std::string("model( ") + c.text + " )");
    ASSERT_EQ(found.size(), 1) << c.text;
    EXPECT_EQ(found[0].kind, "power_pack");
    EXPECT_EQ(found[0].name, "power");
    EXPECT_EQ(number(found[0], "stored"), c.stored) << c.text;
    EXPECT_EQ(number(found[0], "capacity"), c.capacity) << c.text;
    EXPECT_FALSE(infinite(found[0]));
  }
  EXPECT_TRUE(infinite(devices("model( joules -1 )").at(0)));
  EXPECT_THAT(devices("model( mass 5 )"), testing::IsEmpty());
}

TEST_F(StagePowerTest, WhatModelsDrawGoesToTheNearestPack) {
  const std::vector<DeviceSpec> found = devices(
      "position( joules 100 mass 3 watts 50 alwayson 1\n"  // a position works its own draw out
      "  model( watts 2 alwayson 1 )\n"
      "  model( watts 4 )\n"  // does not run
      "  model( joules 9 model( watts 8 alwayson 1 model( watts 16 ctrl \"source 3\" ) ) )\n"
      ")\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: \"watts\" of a model of type position has no "
          "effect: Troupe computes the power of such a model (docs/stage-worlds.md): remove this property"));
  std::vector<const DeviceSpec*> packs;
  for (const DeviceSpec& device : found)
    if (device.kind == "power_pack") packs.push_back(&device);
  ASSERT_EQ(packs.size(), 2);
  EXPECT_EQ(number(*packs[0], "draw"), 2);
  EXPECT_EQ(number(*packs[0], "mass"), 3);
  EXPECT_EQ(number(*packs[0], "idle"), 1);
  EXPECT_EQ(packs[1]->name, "model:2.power");
  EXPECT_EQ(number(*packs[1], "draw"), 24);
  EXPECT_EQ(number(*packs[1], "mass"), 0);
}

TEST_F(StagePowerTest, PacksAndContactsOfModelsWithTheSameNameGetDifferentNames) {
  const std::string bay = R"(model( name "bay" joules 9 take_watts 1 )
  )";
  const std::vector<DeviceSpec> found = devices("position(\n" + bay + bay + bay + ")");
  std::vector<std::string> names;
  for (const DeviceSpec& device : found) names.push_back(device.name);
  EXPECT_THAT(names, ElementsAre("bay.power", "bay.contact", "bay.power#2", "bay.contact#2", "bay.power#3",
                                 "bay.contact#3"));
}

TEST_F(StagePowerTest, ADriveThatNoControllerCommandsDrawsNoRandomNumbers) {
  EXPECT_EQ(number(devices("position( joules 100 mass 3 )").at(0), "idle"), 0);
  EXPECT_EQ(number(devices("position( joules 100 ctrl \"script line\" )").at(0), "idle"), 1);
}

TEST_F(StagePowerTest, GiversAndTakersHaveContacts) {
  const std::vector<DeviceSpec> giver = devices("model( joules -1 give_watts 500 alwayson 1 )");
  ASSERT_EQ(giver.size(), 2);
  EXPECT_EQ(giver[1].kind, "power_contact");
  EXPECT_EQ(giver[1].name, "contact");
  EXPECT_EQ(number(giver[1], "give"), 500);
  EXPECT_TRUE(giver[1].active);
  const std::vector<DeviceSpec> taker = devices("position( joules 9 model( take_watts 70 ) )");
  ASSERT_EQ(taker.size(), 2);
  EXPECT_EQ(taker[1].part, 1);
  EXPECT_EQ(number(taker[1], "take"), 70);
}

TEST_F(StagePowerTest, WarnsOfContactsThatAreOfNoUse) {
  EXPECT_EQ(devices("model( joules -1 give_watts 500 )").size(), 2);
  EXPECT_THAT(messages(),
              ElementsAre(HasSubstr("w.world:1: warning: \"give_watts\" has no effect: a model gives energy "
                                    "only while it runs, for which it needs \"alwayson 1\" or \"ctrl\"")));
  EXPECT_THAT(devices("model( take_watts 70 )"), testing::IsEmpty());
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("have no effect without \"joules\"")));
  EXPECT_THAT(devices("model( when_empty \"nothing\" )"), testing::IsEmpty());
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("\"when_empty\" has no effect without \"joules\"")));
}

TEST_F(StagePowerTest, AnEmptyPackMayBeWithoutEffect) {
  const auto when_empty = [this](const std::string& text) {
    const DeviceSpec pack = devices(text).at(0);
    return engine::get(test_registry().device(pack.kind)->params, pack.params, "when_empty").text();
  };
  EXPECT_EQ(when_empty("model( joules 5 )"), "stop");
  EXPECT_EQ(when_empty("model( joules 5 when_empty \"nothing\" )"), "nothing");
}

TEST_F(StagePowerTest, RefusesWrongEnergies) {
  load(
      "model( joules 5 watts -3 )\nmodel( joules_capacity -5 )\nmodel( joules 5 when_empty \"explode\" )\n"
      "position( joules 1 mass -1 )\nmodel( joules 1 give_watts -1 alwayson 1 )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          HasSubstr("w.world:1: error: \"watts\" must be from 0 to 1000000000, in W, found -3"),
          HasSubstr("w.world:2: error: \"joules_capacity\" must be 0 or above, and at most 1000000000000 J, "
                    "found -5"),
          HasSubstr("w.world:3: error: \"when_empty\" must be \"stop\" or \"nothing\", found "
                    "\"explode\""),
          HasSubstr("w.world:4: error: \"mass\" must be from 0 to 1000000, in kg, found -1"),
          HasSubstr("w.world:5: error: \"give_watts\" must be from 0 to 1000000000")));
}

TEST_F(StagePowerTest, ModelsWithASourceHoldFlags) {
  const std::vector<DeviceSpec> found = devices("model( update_interval 200 ctrl \"source 10 10\" )");
  ASSERT_EQ(found.size(), 1);
  EXPECT_EQ(found[0].kind, "flags");
  EXPECT_EQ(found[0].name, "flags");
  EXPECT_EQ(found[0].period_s, 0.2);
}

}  // namespace
}  // namespace troupe::worldio::stage_power_test
