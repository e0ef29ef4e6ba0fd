#include "partition/box_grid.hpp"

#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace troupe::partition::box_grid_test {
namespace {

using oracle::Draw;

TEST(BoxGrid, FindsAllThatTouchAndFewOthers) {
  std::size_t touching = 0;
  std::size_t looked_at = 0;
  std::size_t all = 0;
  for (std::uint64_t seed = 1; seed <= 300 / oracle::k_thrift; ++seed) {
    Draw draw(seed);
    std::vector<Box> boxes;
    const std::size_t count = draw.below(400);
    const double far = draw.chance(0.3) ? 1e5 : 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (draw.chance(0.05)) {
        boxes.emplace_back();  // empty
        continue;
      }
      Box box = Box::around(Vec2(far + draw.real(-50, 50), draw.real(-50, 50)), draw.scale(0.01, 3));
      if (draw.chance(0.02)) box = box.expanded(draw.real(5, 60));
      if (draw.chance(0.1)) box.max.x() = box.min.x();  // a wall seen from its end
      boxes.push_back(box);
    }
    const BoxGrid grid(boxes);
    for (int query = 0; query < 30; ++query) {
      const Box box = Box::around(Vec2(far + draw.real(-70, 70), draw.real(-70, 70)),
                                  draw.chance(0.1) ? 0 : draw.scale(0.01, 9));
      std::vector<int> visits(boxes.size());
      EXPECT_FALSE(grid.any_near(box, [&](std::uint32_t i) {
        ++visits.at(i);
        return false;
      }));
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const bool touches = !boxes[i].empty() && boxes[i].touches(box);
        ASSERT_TRUE(!touches || visits[i] > 0) << "box " << i << ", seed " << seed;
        ASSERT_TRUE(!boxes[i].empty() || visits[i] == 0);
        touching += touches;
        looked_at += visits[i] > 0;
        ++all;
      }
      const bool any = std::ranges::any_of(visits, [](int n) { return n > 0; });
      int stopped_after = 0;
      EXPECT_EQ(grid.any_near(box, [&](std::uint32_t) { return ++stopped_after == 1; }), any);
      EXPECT_LE(stopped_after, 1);
    }
  }
  EXPECT_GT(touching, 1000u / oracle::k_thrift);
  EXPECT_LT(8 * looked_at, all) << "a grid that shows nearly all is none";
}

TEST(BoxGrid, OfNothingFindsNothing) {
  const auto found = [](std::uint32_t) { return true; };
  EXPECT_FALSE(BoxGrid().any_near(Box::around({0, 0}, 1), found));
  EXPECT_FALSE(BoxGrid(std::vector<Box>(3)).any_near(Box::around({0, 0}, 1), found));
  EXPECT_TRUE(BoxGrid(std::vector<Box>{Box::around({2, 2}, 0)}).any_near(Box::around({1, 1}, 1), found));
}

}  // namespace
}  // namespace troupe::partition::box_grid_test
