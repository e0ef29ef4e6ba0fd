#include "troupe/frame_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace troupe::frame_history_test {
namespace {

using engine::Frame;
using engine::FrameScene;

Frame frame_at(std::uint64_t tick, const std::vector<std::pair<std::uint32_t, Vec2>>& bodies) {
  Frame frame{static_cast<double>(tick) * 0.1, tick, {}};
  for (const auto& [id, place] : bodies)
    frame.mobile.push_back({0, {place.x(), place.y(), 0, 0}, {}, false, id});
  return frame;
}

FrameScene robots() {
  FrameScene scene;
  scene.types = {{{}, true, 0.1}};
  return scene;
}

TEST(Trails, BelongToTheirBodiesAcrossBirthsAndDeaths) {
  Trails trails(0.1);  // a place every 4 ticks
  trails.see(frame_at(0, {{2, {0, 0}}, {5, {5, 0}}}));
  trails.see(frame_at(2, {{2, {9, 9}}}));  // too soon
  trails.see(frame_at(4, {{2, {1, 0}}, {7, {7, 0}}}));
  Frame now = frame_at(6, {{2, {2, 0}}, {7, {7, 1}}, {9, {9, 0}}});
  trails.add_to(now);
  ASSERT_EQ(now.trails.size(), 3u);
  const auto xs = [&](std::size_t i) {
    std::vector<double> x;
    for (const auto& point : now.trails[i].points) x.push_back(point.x());
    return x;
  };
  EXPECT_EQ(xs(0), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(xs(1), (std::vector<double>{7, 7}));
  EXPECT_EQ(xs(2), (std::vector<double>{9}));
}

TEST(Trails, ReachBackTwentySecondsAndBeginAgainWithTheRun) {
  Trails trails(0.1);
  for (std::uint64_t tick = 0; tick <= 1000; ++tick)
    trails.see(frame_at(tick, {{1, {0.1 * static_cast<double>(tick), 0}}}));
  Frame now = frame_at(1000, {{1, {100, 0}}});
  trails.add_to(now);
  EXPECT_NEAR(now.trails[0].points.front().x(), 100 - 20, 0.5);
  EXPECT_FALSE(trails.wants(1003));
  EXPECT_TRUE(trails.wants(1004));
  trails.see(frame_at(3, {{1, {0, 0}}}));
  now = frame_at(5, {{1, {1, 0}}});
  trails.add_to(now);
  EXPECT_EQ(now.trails[0].points.size(), 2u);
}

TEST(Trails, DoNotDependOnTheFirstFrame) {
  const auto trail = [](std::uint64_t first, std::uint64_t every) {
    Trails trails(0.1);
    for (std::uint64_t tick = first; tick <= 301; tick += every)
      trails.see(frame_at(tick, {{1, {static_cast<double>(tick), 0}}}));
    Frame now = frame_at(301, {{1, {301, 0}}});
    trails.add_to(now);
    std::vector<double> x;
    for (const auto& point : now.trails[0].points) x.push_back(point.x());
    return x;
  };
  EXPECT_NEAR(Trails(0.1).history_s(), 20.4, 1e-9);
  const std::vector<double> of_run = trail(0, 1);
  EXPECT_EQ(of_run.front(), 104);
  for (const std::uint64_t first : {97U, 98U, 99U, 100U}) EXPECT_EQ(trail(first, 1), of_run) << first;
  EXPECT_EQ(trail(98, 7), trail(0, 7)) << "every seventh tick, as a recording may have";
}

TEST(Trails, HaveNoPointsFromBeforeAGap) {
  Trails trails(0.1);
  for (const std::uint64_t tick : {0U, 50U, 100U, 400U, 500U, 600U})
    trails.see(frame_at(tick, {{1, {static_cast<double>(tick), 0}}}));
  const auto oldest_at = [&](std::uint64_t tick) {
    Frame now = frame_at(tick, {{1, {0, 0}}});
    trails.add_to(now);
    return now.trails[0].points.front().x();
  };
  EXPECT_EQ(oldest_at(600), 400);
  EXPECT_EQ(oldest_at(601), 500);
  EXPECT_EQ(oldest_at(900), 0) << "only the present position";
}

TEST(Trails, AreAsLongInWorldsWithLongTicks) {
  Trails trails(2);
  for (std::uint64_t tick = 0; tick <= 50; ++tick) trails.see(frame_at(tick, {{1, {0, 0}}}));
  Frame now = frame_at(50, {{1, {0, 0}}});
  trails.add_to(now);
  EXPECT_EQ(now.trails[0].points.size(), 12u) << "11 positions in 20 s, and the present position";
}

TEST(Covered, CountsSquaresInWhichRobotsHaveBeen) {
  const FrameScene scene = robots();
  Covered covered;
  covered.see(scene, frame_at(0, {{1, {0.5, 0.5}}, {2, {-0.5, 3.2}}}));
  covered.see(scene, frame_at(10, {{1, {1.5, 0.5}}, {2, {-0.1, 3.9}}}));
  Frame now = frame_at(10, {});
  covered.add_to(now);
  EXPECT_EQ(now.covered_m, 1);
  ASSERT_EQ(now.covered.size(), 3u);
  EXPECT_EQ(now.covered[0].x, -1);
  EXPECT_EQ(now.covered[0].y, 3);
  EXPECT_EQ(now.covered[0].freshness, 1);
  EXPECT_EQ(now.covered[1].x, 0);
  EXPECT_EQ(now.covered[1].freshness, 0);
  EXPECT_EQ(now.covered[2].x, 1);
  covered.see(scene, frame_at(0, {{1, {8.5, 0.5}}}));  // the run began again
  covered.add_to(now);
  EXPECT_EQ(now.covered.size(), 1u);
}

TEST(Covered, WhatIsNoRobotCoversNothing) {
  FrameScene scene = robots();
  scene.types[0].mobile = false;
  Covered covered;
  covered.see(scene, frame_at(0, {{1, {0.5, 0.5}}}));
  Frame now = frame_at(0, {});
  covered.add_to(now);
  EXPECT_TRUE(now.covered.empty());
}

}  // namespace
}  // namespace troupe::frame_history_test
