#include "live/picture.hpp"

#include "troupe/simulation.hpp"
#include "worldio/results/replay_header.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace troupe::live::picture_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* k_two_bots = R"({"troupe": 1, "bounds_m": [[-9, -9], [9, 9]],
  "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
  "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"x_m": 2, "z_m": 1}}]})";

TEST(LivePicture, HasTheHeightsOfRobotsThatAUserMoves) {
  Simulation simulation = Simulation::from_text(k_two_bots, "w.json", {.threads = 1});
  const worldio::LivePage page = worldio::live_page(simulation.world(), simulation.registry());
  EXPECT_THAT(page.header, HasSubstr(R"("has_z":true)"));
  ASSERT_EQ(page.order.size(), 2u);
  Picture picture;
  const auto heights = [&] {
    take(simulation.world(), page.order, false, page.shown_parts, picture);
    return std::vector<std::int32_t>{picture.poses.at(6), picture.poses.at(7)};
  };
  EXPECT_THAT(heights(), ElementsAre(0, 1000));
  simulation.act({.kind = engine::Act::Kind::move, .whom = "a", .pose = {3, 3, 2, 0}});
  EXPECT_THAT(heights(), ElementsAre(2000, 1000));

  SentPicture sent;
  picture.number = 1;
  // Number; robot a: x, y, heading, z; robot b: the same; end of the poses; end of the colours.
  const std::string bytes = encode(picture, 2, 0, sent);
  EXPECT_EQ(bytes.size(), 1U + (1 + 2 + 2 + 1 + 2) + (1 + 2 + 1 + 1 + 2) + 1 + 1);
  EXPECT_EQ(sent.poses, picture.poses);
}

std::string header_of(const char* world) {
  const Simulation simulation = Simulation::from_text(world, "w.json", {.threads = 1});
  return worldio::live_page(simulation.world(), simulation.registry()).header;
}

TEST(LivePicture, ShowsTheFloorOfAWorldWithoutBodies) {
  EXPECT_THAT(header_of(R"({"troupe": 1, "bounds_m": [[-9, -8], [7, 6]]})"),
              HasSubstr(R"("bounds_m":[-9.0,-8.0,7.0,6.0])"));
  EXPECT_THAT(header_of(R"({"troupe": 1})"), HasSubstr(R"("bounds_m":[-5.0,-5.0,5.0,5.0])"));
  EXPECT_THAT(header_of(R"({"troupe": 1, "bounds_m": [[-9, -8], [7, 6]],
    "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
    "populations": [{"name": "b", "type": "bot", "count": 0, "reserve": 3, "place": {"rule": "uniform"}}]})"),
              HasSubstr(R"("bounds_m":[-9.0,-8.0,7.0,6.0])"));
}

}  // namespace
}  // namespace troupe::live::picture_test
