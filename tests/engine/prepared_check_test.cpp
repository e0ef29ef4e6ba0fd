#include "engine/spec/prepared_check.hpp"

#include "engine/kinds/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace troupe::engine::prepared_check_test {
namespace {

using Prepared = DeviceKind::Prepared;
using testing::HasSubstr;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// The error for `prepared` of a kind that acts; empty: none.
std::string error(const Prepared& prepared) {
  DeviceKind kind{.name = "kind", .text = ""};
  kind.act = [](const DeviceBatch&) {};
  const Result<> fits = check_prepared(kind, prepared);
  return fits ? std::string() : fits.error().text;
}

struct State {
  double a = 0;
  float b = 0;
  std::uint8_t c = 0;
  TROUPE_FIELDS(a, b, c)
};

/// What a correct kind prepares, with one change.
template <class Change>
std::string error_after(Change change) {
  Prepared prepared{.percepts = memory_fields<State>(),
                    .percept_bytes = sizeof(State),
                    .commands = memory_fields<State>(),
                    .command_bytes = sizeof(State),
                    .reach_m = 2,
                    .most_effects = 1};
  change(prepared);
  return error(prepared);
}

TEST(PreparedCheck, AcceptsWhatMemoryFieldsReturns) {
  EXPECT_EQ(error({}), "");
  EXPECT_EQ(error_after([](Prepared&) {}), "");
  EXPECT_EQ(error_after([](Prepared& p) { p.reach_m = k_infinity; }), "");
}

TEST(PreparedCheck, RefusesFieldsThatAreNoStruct) {
  EXPECT_THAT(error_after([](Prepared& p) { p.percept_bytes = 4; }), HasSubstr("of a struct of 4 bytes"));
  EXPECT_THAT(error_after([](Prepared& p) { p.command_bytes = 1; }), HasSubstr("of a struct of 1 bytes"));
  EXPECT_THAT(error_after([](Prepared& p) { p.percepts[1].offset = 4; }),
              HasSubstr("has the percept \"b\", which overlaps another percept"));
  EXPECT_THAT(error_after([](Prepared& p) { p.commands[1].offset = 9; }),
              HasSubstr("has the command \"b\" at the offset 9, which is no multiple of its size"));
  EXPECT_THAT(error_after([](Prepared& p) { p.percepts[2].columns = 100; }), HasSubstr("ends at byte 112"));
  EXPECT_EQ(error_after([](Prepared& p) { p.percepts[1].name = "a"; }),
            "has two percepts with the name \"a\"");
  for (const char* name : {"", "x/y"})
    EXPECT_THAT(error_after([&](Prepared& p) { p.percepts[0].name = name; }),
                HasSubstr("a name must not be empty or contain \"/\""));
  EXPECT_THAT(error_after([](Prepared& p) { p.percepts[0].element = static_cast<Element>(50); }),
              HasSubstr("of an unknown type (Element): 50"));
}

TEST(PreparedCheck, RefusesNumbersWithoutMeaning) {
  for (const double x : {-1.0, k_nan}) {
    EXPECT_THAT(error_after([&](Prepared& p) { p.reach_m = x; }), HasSubstr("reach_m"));
    EXPECT_THAT(error_after([&](Prepared& p) { p.cell_hint_m = x; }), HasSubstr("cell_hint_m"));
    EXPECT_THAT(error_after([&](Prepared& p) { p.watts = x; }), HasSubstr("watts"));
  }
  EXPECT_THAT(error_after([](Prepared& p) { p.cell_hint_m = k_infinity; }), HasSubstr("cell_hint_m"));
  EXPECT_THAT(error_after([](Prepared& p) { p.joints = {{}}; }),
              HasSubstr("has 1 poses of joints (Prepared::joints), but 0 joints"));
}

TEST(PreparedCheck, RefusesRangersWithOtherNumbersOfBeams) {
  const auto ranger = [](std::size_t ranges, std::size_t first, std::size_t samples) {
    return error({.percepts = {{"ranges", Element::f32, static_cast<std::uint32_t>(ranges), "m", ""}},
                  .bearings = {0, 1, 2},
                  .transducers = {{.first = first, .samples = samples}}});
  };
  EXPECT_EQ(ranger(3, 0, 3), "");
  EXPECT_EQ(ranger(9, 0, 3),
            "has 3 bearings, so its first percept must have 3 columns of type f32, the ranges");
  EXPECT_EQ(
      ranger(3, 1, 3),
      "has a fan of 3 readings that begins with reading 1 (Prepared::transducers), but only 3 bearings");
}

struct Place {
  double x = 0, y = 0, z = 0, heading = 0;
  TROUPE_FIELDS(x, y, z, heading)
};

TEST(PreparedCheck, RefusesDriveDevicesWithoutCommandOrPose) {
  DeviceKind wheels{.name = "kind", .text = ""};
  wheels.drives = true;
  const Prepared correct{.percepts = memory_fields<Place>(),
                         .percept_bytes = sizeof(Place),
                         .commands = command_fields(),
                         .command_bytes = sizeof(Command)};
  EXPECT_TRUE(check_prepared(wheels, correct));
  const auto error_of = [&](auto change) {
    Prepared prepared = correct;
    change(prepared);
    const Result<> fits = check_prepared(wheels, prepared);
    return fits ? std::string() : fits.error().text;
  };
  EXPECT_THAT(error_of([](Prepared& p) { p.commands.clear(); }), HasSubstr("must be a Command"));
  EXPECT_THAT(error_of([](Prepared& p) { p.commands.pop_back(); }), HasSubstr("must be a Command"));
  EXPECT_THAT(error_of([](Prepared& p) { p.command_bytes = 0; }), HasSubstr("must be a Command"));
  EXPECT_THAT(error_of([](Prepared& p) { p.percepts.pop_back(); }),
              HasSubstr("its state must begin with a Pose"));
}

TEST(PreparedCheck, RefusesEffectsOfSensors) {
  const DeviceKind sensor{.name = "kind", .text = ""};
  EXPECT_THAT(check_prepared(sensor, {.most_effects = 1}).error().text,
              HasSubstr("which only the hook \"act\" may emit"));
}

TEST(PreparedCheck, RefusesMoreEffectsThanMemoryHolds) {
  EXPECT_EQ(error_after([](Prepared& p) { p.most_effects = 1'000'000; }), "");
  EXPECT_EQ(error_after([](Prepared& p) { p.most_effects = 1'000'001; }),
            "declares up to 1000001 effects in a tick (most_effects): at most 1000000 are allowed");
  EXPECT_THAT(error_after([](Prepared& p) { p.most_effects = std::numeric_limits<std::size_t>::max(); }),
              HasSubstr("at most 1000000 are allowed"));
}

std::string memory_error(std::vector<StateField> fields, std::size_t bytes) {
  ControllerKind kind{.name = "kind", .text = ""};
  kind.memory = std::move(fields);
  kind.memory_bytes = bytes;
  const Result<> fits = check_memory(kind);
  return fits ? std::string() : fits.error().text;
}

TEST(PreparedCheck, RefusesMemoriesThatAreNoStruct) {
  EXPECT_EQ(memory_error({}, 0), "");
  EXPECT_EQ(memory_error(memory_fields<State>(), sizeof(State)), "");
  EXPECT_THAT(memory_error(memory_fields<State>(), 0), HasSubstr("set memory_bytes"));
  EXPECT_THAT(memory_error(memory_fields<State>(), 8),
              HasSubstr("has the memory field \"b\", which ends at byte 12 of a struct of 8 bytes"));
  EXPECT_EQ(memory_error({{"a/b", Element::f64, 1, "", ""}}, 8),
            "has a memory field with the name \"a/b\": a name must not be empty or contain \"/\"");
}

}  // namespace
}  // namespace troupe::engine::prepared_check_test
