#include "engine/observing/state_difference.hpp"

#include "tests/support/scene.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace troupe::engine::state_difference_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Two types of robots that see one another; `shift_m` moves the third to the right.
test::SceneBuilder crowd(double shift_m = 0) {
  test::SceneBuilder scene;
  for (const char* name : {"a", "b"}) {
    const TypeId type = scene.robot(name, {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}});
    scene[type].devices.push_back(test::ranger("eye", {{.pose = {0, 0, 0.1, 0}, .fov = 3, .samples = 5}}));
    for (int i = 0; i < 3; ++i)
      scene.body(fmt::format("{}{}", name, i), type,
                 {1.0 * i + (std::string(name) == "a" && i == 2 ? shift_m : 0), name[0] - 'a' + 0.0, 0, 0});
  }
  return scene;
}

std::vector<std::string> texts(World& first, World& second) {
  std::vector<std::string> lines;
  for (const ComponentDifference& difference : state_differences(first, second))
    lines.push_back(difference_text(first, difference));
  return lines;
}

TEST(ValueText, ShowsBitsAndValue) {
  EXPECT_EQ(value_text({Element::f64, std::bit_cast<std::uint64_t>(0.5)}), "0x3fe0000000000000 (0.5)");
  EXPECT_EQ(value_text({Element::f64, std::bit_cast<std::uint64_t>(std::nextafter(0.5, 1.0))}),
            "0x3fe0000000000001 (0.5000000000000001)");
  EXPECT_EQ(value_text({Element::f64, std::bit_cast<std::uint64_t>(-0.0)}), "0x8000000000000000 (-0)");
  EXPECT_EQ(value_text({Element::f32, std::bit_cast<std::uint32_t>(0.1f)}), "0x3dcccccd (0.1)");
  EXPECT_EQ(value_text({Element::i64, ~std::uint64_t{0}}), "0xffffffffffffffff (-1)");
  EXPECT_EQ(value_text({Element::i32, 0xfffffffe}), "0xfffffffe (-2)");
  EXPECT_EQ(value_text({Element::u32, 0xfffffffe}), "0xfffffffe (4294967294)");
  EXPECT_EQ(value_text({Element::u8, 2}), "0x02 (2)");
}

TEST(StateDifferences, AreNoneBetweenThreadsAndTiles) {
  World first = crowd().world({.threads = 1, .tile_size_m = 0.5});
  World second = crowd().world({.threads = 3});
  for (int tick = 0; tick < 3; ++tick) {
    EXPECT_THAT(texts(first, second), IsEmpty());
    first.step();
    second.step();
  }
}

TEST(StateDifferences, NameComponentRobotFieldAndBothValues) {
  World first = crowd().world();
  World second = crowd().world();
  second.set_command(second.view().row(second.state().names.find("b1")), {0, 0, 0.25});
  EXPECT_THAT(
      texts(first, second),
      ElementsAre("command: turn of \"b1\" (id 5) is 0x3fd0000000000000 (0.25), not 0x0000000000000000 "
                  "(0); 1 body differs"));
}

TEST(StateDifferences, CountRobotsAndNameTheLowest) {
  World first = crowd().world();
  World second = crowd().world();
  for (const char* name : {"b2", "a1", "b0"})
    second.set_command(second.view().row(second.state().names.find(name)), {1, 0, 2});
  const auto found = state_differences(first, second);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].bodies, 3u);
  EXPECT_EQ(found[0].body, second.state().names.find("a1"));
  EXPECT_EQ(found[0].field, "x");
}

TEST(StateDifferences, ComeInTheOrderOfThePhases) {
  World first = crowd().world();
  World second = crowd(std::ldexp(1.0, -40)).world();
  EXPECT_THAT(texts(first, second), ElementsAre(StartsWith("pose: x of \"a2\" (id 3) is 0x4000000000")));
  first.step();
  second.step();
  World third = crowd(0.3).world();
  third.step();
  const std::vector<std::string> lines = texts(first, third);
  ASSERT_EQ(lines.size(), 2u) << ::testing::PrintToString(lines);
  EXPECT_THAT(lines[0], StartsWith("ranger/eye: ranges["));
  EXPECT_THAT(lines[1], StartsWith("pose: x of \"a2\""));
}

TEST(StateDifferences, TellOfZerosAndOfNumbersThatAreNone) {
  World first = crowd().world();
  World second = crowd().world();
  first.set_command(first.view().row(first.state().names.find("a0")), {0.0, 0, 0});
  second.set_command(second.view().row(second.state().names.find("a0")), {-0.0, 0, 0});
  EXPECT_THAT(texts(first, second),
              ElementsAre(HasSubstr("0x8000000000000000 (-0), not 0x0000000000000000 (0)")));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (World* world : {&first, &second})
    world->set_command(world->view().row(world->state().names.find("a0")), {nan, 0, 0});
  EXPECT_THAT(texts(first, second), IsEmpty()) << "the same bits";
}

TEST(StateDifferences, TellOfOtherEntities) {
  World first = crowd().world();
  test::SceneBuilder more = crowd();
  more.body("late", TypeId(std::size_t{1}), {9, 9, 0, 0});
  World second = more.world();
  EXPECT_THAT(texts(first, second), ::testing::Contains("pose: the states have different bodies or fields"));
}

}  // namespace
}  // namespace troupe::engine::state_difference_test
