#include "partition/body_index.hpp"

#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

namespace troupe::partition::body_index_test {
namespace {

using oracle::Draw;

constexpr std::array<GridGeometry, 5> k_grids{{{0.2, 4}, {1, 3}, {1, 0}, {3.7, 2}, {50, 5}}};

struct Bodies {
  std::vector<Transform> places;
  std::vector<double> radii;
};

/// Crowds of bodies around the origin, some lying exactly on the borders of cells, some far away.
Bodies random_bodies(Draw& draw, std::size_t count, double far, double widest = 8) {
  Bodies bodies;
  const double extent = draw.scale(1, 60);
  if (draw.chance(0.5)) widest = 0.5;
  for (std::size_t i = 0; i < count; ++i) {
    Vec2 p(draw.real(-extent, extent), draw.real(-extent, extent));
    if (draw.chance(0.1)) p = p.array().round();
    bodies.places.emplace_back(Pose{p.x() + far, p.y() - far, 0, 0});
    bodies.radii.push_back(draw.chance(0.05) ? 0 : draw.scale(0.02, widest));
  }
  return bodies;
}

/// Whether the box touches the circle.
bool may_touch(const Box& box, const Vec2& p, double radius) {
  const double x = std::max({box.min.x() - p.x(), 0.0, p.x() - box.max.x()});
  const double y = std::max({box.min.y() - p.y(), 0.0, p.y() - box.max.y()});
  return x * x + y * y <= radius * radius;
}

/// Expects that the circle encloses the exact circle of the body, and is not much larger. Long double has
/// enough digits for this comparison.
void expect_encloses(const BodyCircle& circle, const Bodies& bodies) {
  const long double x = static_cast<long double>(circle.x) - bodies.places[circle.row].position.x();
  const long double y = static_cast<long double>(circle.y) - bodies.places[circle.row].position.y();
  EXPECT_LE(std::sqrt(x * x + y * y) + bodies.radii[circle.row], static_cast<long double>(circle.radius));
  EXPECT_LE(
      static_cast<double>(circle.radius),
      bodies.radii[circle.row] * (1 + 1e-6) + 1.3e-7 * bodies.places[circle.row].position.norm() + 1e-30);
}

TEST(BodyIndex, QueriesFindAllThatLieNearEachOnce) {
  Parallel parallel(2);
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 600 / oracle::k_thrift; ++seed) {
    Draw draw(seed);
    const double far = draw.chance(0.2) ? 1e5 : draw.chance(0.2) ? -300 : 0;
    BodyIndex index(k_grids[seed % k_grids.size()]);
    const double index_cell = k_grids[seed % k_grids.size()].cell_m;
    // The index is filled three times. Its earlier contents must have no effect.
    for (int filling = 0; filling < 3; ++filling) {
      const Bodies bodies = random_bodies(draw, draw.below(300), far);
      index.rebuild(bodies.places, bodies.radii, parallel);
      for (int query = 0; query < 20; ++query) {
        const Box box =
            Box::around(Vec2(far, -far) + Vec2(draw.real(-60, 60), draw.real(-60, 60)), draw.scale(0.01, 30));
        std::vector<int> visits(bodies.places.size());
        index.for_each_near(box, [&](const BodyCircle& circle) {
          ++visits.at(circle.row);
          expect_encloses(circle, bodies);
        });
        std::vector<int> in_runs(bodies.places.size());
        index.for_each_run(box, [&](std::span<const BodyCircle> run) {
          ASSERT_FALSE(run.empty());
          for (const BodyCircle& circle : run) ++in_runs.at(circle.row);
        });
        for (std::size_t r = 0; r < visits.size(); ++r) {
          ASSERT_LE(visits[r], 1) << "row " << r << ", seed " << seed;
          ASSERT_EQ(in_runs[r] > 0, visits[r] > 0) << "row " << r << ", seed " << seed;
          const bool wide = bodies.radii[r] > 0.5 * index_cell;
          ASSERT_TRUE(wide || in_runs[r] <= 1) << "row " << r << ", seed " << seed;
          if (!may_touch(box, bodies.places[r].position, bodies.radii[r])) continue;
          ASSERT_EQ(visits[r], 1) << "row " << r << " of radius " << bodies.radii[r] << ", seed " << seed;
          ++found;
        }
      }
    }
  }
  EXPECT_GT(found, 50'000 / oracle::k_thrift);
}

// The nearest point of the circle is 1.8 - 0.38 = 1.42 m away, but 1.42 + 0.38 is rounded to a number below
// 1.8, where a cell begins.
TEST(BodyIndex, RoundingAtTheBorderOfACellHidesNoBody) {
  ASSERT_EQ(1.8 - 0.38, 1.42);
  ASSERT_LT(1.42 + 0.38, 1.8);
  Parallel parallel(1);
  const std::vector<Transform> places{Transform(Pose{1.8, 0, 0, 0})};
  const std::vector<double> radii{0.38};
  BodyIndex index({0.9, 1});
  index.rebuild(places, radii, parallel);
  std::size_t visits = 0;
  index.for_each_near(Box::around({0, 0}, 1.42), [&](const BodyCircle&) { ++visits; });
  EXPECT_EQ(visits, 1u);
  index.for_each_run(Box::around({0, 0}, 1.42),
                     [&](std::span<const BodyCircle> run) { visits += run.size(); });
  EXPECT_EQ(visits, 2u);
}

TEST(BodyIndex, LeavesOutMostOfWhatIsFar) {
  Parallel parallel(1);
  Draw draw(1);
  Bodies bodies;
  for (int i = 0; i < 10'000; ++i) {
    bodies.places.emplace_back(Pose{draw.real(0, 100), draw.real(0, 100), 0, 0});
    bodies.radii.push_back(0.1);
  }
  // One wide body must not make every query search a larger area.
  bodies.places.emplace_back(Pose{50, 50, 0, 0});
  bodies.radii.push_back(20);
  BodyIndex index({1, 3});
  index.rebuild(bodies.places, bodies.radii, parallel);
  std::size_t visited = 0;
  index.for_each_near(Box::around({50, 50}, 0.5), [&](const BodyCircle&) { ++visited; });
  EXPECT_GT(visited, 1u);
  EXPECT_LT(visited, 30u);
}

TEST(BodyIndex, SaysHowManyEntriesABodyCanHave) {
  Parallel parallel(1);
  Draw draw(1);
  for (const double cell_m : {0.5, 1.0, 3.0})
    for (const double radius : {0.1, 0.5, 0.6, 1.2, 7.4, 31.9, 33.0, 1e5}) {
      const double most = BodyIndex::most_entries(radius * cell_m, cell_m);
      std::size_t found = 0;
      for (int i = 0; i < 100; ++i) {
        const std::vector<Transform> places{Transform(Pose{draw.real(-50, 50), draw.real(-50, 50), 0, 0})};
        const std::vector<double> radii{radius * cell_m};
        BodyIndex index({cell_m, 4});
        index.rebuild(places, radii, parallel);
        std::size_t entries = 0;
        index.for_each_run(Box::around(places[0].position, 40 * cell_m),
                           [&](std::span<const BodyCircle> run) { entries += run.size(); });
        found = std::max(found, entries);
      }
      EXPECT_EQ(static_cast<double>(found), most) << radius << " cells of " << cell_m << " m";
      EXPECT_EQ(BodyIndex::is_huge(radius * cell_m, cell_m), radius > 32);
    }
}

// A body that covers 10^14 cells has no entry in each of them; queries find it nevertheless.
TEST(BodyIndex, FindsHugeBodiesWhateverTheirSize) {
  for (const unsigned threads : {1u, 3u}) {
    Parallel parallel(threads);
    Draw draw(1);
    Bodies bodies = random_bodies(draw, 3000, 0, 0.5);
    const std::vector<std::uint32_t> huge{0, 1500, 2999};
    BodyIndex index({0.2, 4});
    const auto expect_found_at = [&](const Vec2& point, const std::vector<std::uint32_t>& expected) {
      const auto is_huge = [&](const BodyCircle& circle) { return circle.radius > 1e5f; };
      std::vector<std::uint32_t> found;
      index.for_each_near(Box::around(point, 1), [&](const BodyCircle& circle) {
        if (is_huge(circle)) found.push_back(circle.row);
      });
      EXPECT_EQ(found, expected);
      std::set<std::uint32_t> in_runs;
      index.for_each_run(Box::around(point, 1), [&](std::span<const BodyCircle> run) {
        for (const BodyCircle& circle : run)
          if (is_huge(circle)) in_runs.insert(circle.row);
      });
      EXPECT_TRUE(std::ranges::equal(in_runs, expected));
      std::vector<std::uint32_t> rows(index.order().begin(), index.order().end());
      std::ranges::sort(rows);
      std::vector<std::uint32_t> all(bodies.places.size());
      std::iota(all.begin(), all.end(), 0u);
      EXPECT_EQ(rows, all);
    };
    for (const std::uint32_t row : huge) bodies.radii[row] = 1e6;
    index.rebuild(bodies.places, bodies.radii, parallel);
    EXPECT_TRUE(index.has_wide());
    expect_found_at({5, 5}, huge);
    expect_found_at({-4e5, 4e5}, huge);
    for (const std::uint32_t row : huge) bodies.radii[row] = 0.05;
    index.rebuild(bodies.places, bodies.radii, parallel);
    expect_found_at({5, 5}, {});
    expect_found_at({-4e5, 4e5}, {});
  }
}

TEST(BodyIndex, IsEmptyAtFirstAndCanBeEmptied) {
  Parallel parallel(2);
  BodyIndex index({1, 3});
  const auto visit_all = [&] {
    std::size_t visited = 0;
    index.for_each_near(Box::around({0, 0}, 100), [&](const BodyCircle&) { ++visited; });
    return visited;
  };
  EXPECT_EQ(visit_all(), 0u);
  index.rebuild({}, {}, parallel);
  EXPECT_EQ(visit_all(), 0u);
  EXPECT_TRUE(index.order().empty());
  const std::vector<Transform> positions{Transform(Pose{1, 1, 0, 0})};
  const std::vector<double> radii{0.1};
  index.rebuild(positions, radii, parallel);
  EXPECT_EQ(visit_all(), 1u);
  index.rebuild({}, {}, parallel);
  EXPECT_EQ(visit_all(), 0u);
}

TEST(BodyIndex, ForgetsTilesLongLeft) {
  Parallel parallel(1);
  BodyIndex index({1, 0});
  const std::vector<double> radii{0.1};
  for (int i = 0; i < 1000; ++i) {
    const std::vector<Transform> positions{Transform(Pose{static_cast<double>(i), 0, 0, 0})};
    index.rebuild(positions, radii, parallel);
    std::size_t visited = 0;
    index.for_each_near(Box::around(positions[0].position, 1), [&](const BodyCircle&) { ++visited; });
    ASSERT_EQ(visited, 1u);
  }
  EXPECT_LT(index.tiles(), 100u);
}

// The cells of the index are numbered with 32 bits. Without the error, the numbers would wrap around.
TEST(BodyIndex, RejectsMoreCellsThanItCanNumber) {
  Parallel parallel(1);
  BodyIndex index({1, 20});
  const std::vector<double> radii{0.1};
  const std::vector<Transform> places{Transform(Pose{1, 1, 0, 0})};
  try {
    index.rebuild(places, radii, parallel);
    FAIL() << "accepts 2^40 cells";
  } catch (const std::length_error& error) {
    EXPECT_STREQ(error.what(),
                 "the spatial index of the bodies would have 1099511627776 cells; at most 4294967295 are "
                 "allowed: set a smaller WorldOptions::tile_size_m (--tile-size)");
  }
  index.rebuild({}, {}, parallel);
  EXPECT_TRUE(index.order().empty());
}

// Queries visit the same entries in the same order for every number of threads. order() contains each row
// once, and the rows of one tile are adjacent.
TEST(BodyIndex, IsTheSameOnAnyNumberOfThreads) {
  std::vector<Parallel> teams;
  for (const unsigned threads : {1u, 2u, 3u, 8u}) teams.emplace_back(threads);
  for (std::uint64_t seed = 1; seed <= 40 / oracle::k_thrift; ++seed) {
    Draw draw(seed);
    const GridGeometry grid = k_grids[seed % k_grids.size()];
    const Bodies bodies = random_bodies(draw, 5000, 0, 1.5);
    std::vector<std::uint32_t> order;
    std::vector<std::uint32_t> visited;
    for (Parallel& parallel : teams) {
      BodyIndex index(grid);
      index.rebuild(bodies.places, bodies.radii, parallel);
      std::vector<std::uint32_t> rows;
      index.for_each_near(Box::around({0, 0}, 30),
                          [&](const BodyCircle& circle) { rows.push_back(circle.row); });
      if (&parallel == &teams.front()) {
        order.assign(index.order().begin(), index.order().end());
        visited = rows;
      }
      ASSERT_TRUE(std::ranges::equal(index.order(), order))
          << parallel.threads() << " threads, seed " << seed;
      ASSERT_EQ(rows, visited) << parallel.threads() << " threads, seed " << seed;
    }

    std::vector<std::uint32_t> sorted = order;
    std::ranges::sort(sorted);
    std::vector<std::uint32_t> all(5000);
    std::iota(all.begin(), all.end(), 0u);
    ASSERT_EQ(sorted, all);
    // (block, cell, row) order: within a tile, blocks row by row, in each of them cells row by row, and rows
    // ascending within a cell.
    const auto place = [&](Cell c) {
      const Cell block = grid.block(c);
      return std::tuple(block.y, block.x, c.y, c.x);
    };
    BodyIndex index(grid);
    index.rebuild(bodies.places, bodies.radii, teams.front());
    std::vector<Cell> tiles;
    std::uint32_t home = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Cell cell = grid.cell(bodies.places[order[i]].position);
      const auto last_home = home;
      home = index.home(order[i]);
      if (i > 0) {
        const Cell before = grid.cell(bodies.places[order[i - 1]].position);
        ASSERT_EQ(before == cell, last_home == home);
        if (grid.tile(before) == grid.tile(cell)) {
          ASSERT_LT(std::pair(place(before), order[i - 1]), std::pair(place(cell), order[i]));
          continue;
        }
      }
      ASSERT_EQ(std::ranges::count(tiles, grid.tile(cell)), 0) << "a tile's rows lie together";
      tiles.push_back(grid.tile(cell));
    }
  }
}

}  // namespace
}  // namespace troupe::partition::body_index_test
