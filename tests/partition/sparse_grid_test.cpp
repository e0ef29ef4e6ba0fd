#include "partition/sparse_grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <utility>

namespace troupe::partition::sparse_grid_test {
namespace {

TEST(GridGeometry, CellsHoldTheirLowerEdges) {
  const GridGeometry grid{0.5, 2};
  EXPECT_EQ(grid.cell({0, 0}), (Cell{0, 0}));
  EXPECT_EQ(grid.cell({0.49, 0.5}), (Cell{0, 1}));
  EXPECT_EQ(grid.cell({-0.01, -0.5}), (Cell{-1, -1}));
  EXPECT_EQ(grid.cell({-0.51, 1e5}), (Cell{-2, 200'000}));
}

TEST(GridGeometry, PointsBeyondAllCellsLieInTheOutermost) {
  const GridGeometry grid{0.001, 3};
  EXPECT_EQ(grid.cell({1e300, -1e300}), (Cell{1 << 30, -(1 << 30)}));
}

TEST(GridGeometry, TilesAreCutOnBothSidesOfTheOrigin) {
  const GridGeometry grid{1, 3};
  EXPECT_EQ(grid.cells_per_tile(), 64u);
  EXPECT_DOUBLE_EQ(grid.tile_m(), 8);
  EXPECT_EQ(grid.tile({7, 8}), (Cell{0, 1}));
  EXPECT_EQ(grid.tile({-1, -8}), (Cell{-1, -1}));
  EXPECT_EQ(grid.tile({-9, 0}), (Cell{-2, 0}));
  std::set<std::size_t> places;
  for (std::int32_t y = -8; y < 0; ++y)
    for (std::int32_t x = -8; x < 0; ++x) {
      places.insert(grid.in_tile({x, y}));
      EXPECT_TRUE(x == -1 || grid.in_tile({x + 1, y}) == grid.in_tile({x, y}) + 1) << "a row is one run";
    }
  EXPECT_EQ(places.size(), 64u);
  EXPECT_EQ(*places.rbegin(), 63u);
}

TEST(TileDirectory, FindsWhatWasPutIn) {
  std::mt19937 words(1);
  TileDirectory directory;
  std::map<std::pair<int, int>, std::uint32_t> known;
  const auto draw = [&] {
    // Tiles near the origin, on a line, and anywhere: a weak hash would give many of them the same place.
    switch (words() % 3) {
      case 0: return Cell{static_cast<int>(words() % 50) - 25, static_cast<int>(words() % 50) - 25};
      case 1: return Cell{static_cast<int>(words() % 5000) << 16, 0};
      default: return Cell{static_cast<int>(words()), static_cast<int>(words())};
    }
  };
  for (int i = 0; i < 20'000; ++i) {
    const Cell tile = draw();
    const auto seen = known.find({tile.x, tile.y});
    ASSERT_EQ(directory.find(tile), seen == known.end() ? TileDirectory::k_none : seen->second);
    if (i % 2 == 0) continue;
    const std::uint32_t slot = directory.insert(tile);
    if (seen == known.end()) {
      ASSERT_EQ(slot, known.size()) << "slots are dense";
      known[{tile.x, tile.y}] = slot;
    } else {
      ASSERT_EQ(slot, seen->second);
    }
    ASSERT_EQ(directory.tile(slot), tile);
  }
  EXPECT_EQ(directory.size(), known.size());
  for (const auto& [tile, slot] : known) EXPECT_EQ(directory.find({tile.first, tile.second}), slot);
  directory.clear();
  EXPECT_EQ(directory.size(), 0u);
  EXPECT_EQ(directory.find({0, 0}), TileDirectory::k_none);
}

TEST(ForEachRun, VisitsEachCellOfTheBoxInATileThatExists) {
  std::mt19937 words(2);
  for (const unsigned bits : {0u, 1u, 3u, 5u}) {
    const GridGeometry grid{1, bits};
    TileDirectory directory;
    for (int i = 0; i < 30; ++i)
      directory.insert({static_cast<int>(words() % 9) - 4, static_cast<int>(words() % 9) - 4});
    for (int i = 0; i < 200; ++i) {
      const auto any = [&] { return static_cast<double>(words() % 4000) / 100 - 20; };
      Box box;
      box.extend(Vec2(any(), any()));
      box.extend(Vec2(any(), any()));
      std::set<std::pair<std::uint32_t, std::size_t>> visited;
      for_each_run(grid, directory, box,
                   [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell cell) {
                     EXPECT_EQ(grid.in_tile(cell), first);
                     EXPECT_EQ(directory.find(grid.tile(cell)), slot);
                     for (std::size_t c = first; c < last; ++c)
                       EXPECT_TRUE(visited.emplace(slot, c).second) << "visited twice";
                   });
      std::set<std::pair<std::uint32_t, std::size_t>> expected;
      const Cell low = grid.cell(box.min);
      const Cell high = grid.cell(box.max);
      for (std::int32_t y = low.y; y <= high.y; ++y)
        for (std::int32_t x = low.x; x <= high.x; ++x)
          if (const std::uint32_t slot = directory.find(grid.tile({x, y})); slot != TileDirectory::k_none)
            expected.emplace(slot, grid.in_tile({x, y}));
      EXPECT_EQ(visited, expected);
    }
  }
}

}  // namespace
}  // namespace troupe::partition::sparse_grid_test
