#include "partition/tile_owners.hpp"

#include "base/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <vector>

namespace troupe::partition::tile_owners_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(TileOwners, SuccessiveKeysAreNeighbours) {
  std::map<TileOwners::Key, Cell> tiles;
  for (std::int32_t y = -8; y < 8; ++y)
    for (std::int32_t x = -8; x < 8; ++x) tiles[TileOwners::key(Cell{x, y})] = {x, y};
  EXPECT_EQ(tiles.size(), 256u) << "two tiles have one key";
  // The curve visits the four quarters of the plane one after another.
  int jumps = 0;
  for (auto next = std::next(tiles.begin()), at = tiles.begin(); next != tiles.end(); ++at, ++next) {
    const int distance = std::abs(at->second.x - next->second.x) + std::abs(at->second.y - next->second.y);
    if (next->first == at->first + 1) {
      EXPECT_EQ(distance, 1);
    } else {
      ++jumps;
    }
  }
  EXPECT_LE(jumps, 3);
}

TEST(TileOwners, EqualCutsGiveRanksEqualNumbers) {
  EXPECT_THAT(TileOwners::equal_cut(std::vector<TileOwners::Key>{1, 2, 3, 4, 5, 6}, 3), ElementsAre(3, 5));
  EXPECT_THAT(TileOwners::equal_cut(std::vector<TileOwners::Key>{7, 7, 7}, 3), ElementsAre(7, 7));
  EXPECT_THAT(TileOwners::equal_cut(std::vector<TileOwners::Key>{}, 3), ElementsAre(0, 0));
  EXPECT_THAT(TileOwners::equal_cut(std::vector<TileOwners::Key>{1}, 1), IsEmpty());
}

TEST(TileOwners, RandomCutsContainEmptyRanksAndRanksOfOneTile) {
  const std::vector<TileOwners::Key> keys{3, 3, 4, 8, 20, 21, 21, 50, 51, 52, 90};
  int empty = 0;
  int of_one_tile = 0;
  int wider = 0;
  for (std::uint32_t tick = 0; tick < 30; ++tick) {
    Random random(1, 2, 0, tick);
    const std::vector<TileOwners::Key> cut = TileOwners::random_cut(keys, 7, random);
    ASSERT_EQ(cut.size(), 6u);
    for (std::size_t rank = 1; rank < cut.size(); ++rank) {
      ASSERT_LE(cut[rank - 1], cut[rank]);
      const TileOwners::Key tiles = cut[rank] - cut[rank - 1];
      tiles == 0 ? ++empty : tiles == 1 ? ++of_one_tile : ++wider;
    }
    Random again(1, 2, 0, tick);
    EXPECT_EQ(TileOwners::random_cut(keys, 7, again), cut);
  }
  EXPECT_GT(empty, 10);
  EXPECT_GT(of_one_tile, 10);
  EXPECT_GT(wider, 10);
  Random random(1, 2, 0, 0);
  EXPECT_THAT(TileOwners::random_cut(keys, 1, random), IsEmpty());
  EXPECT_THAT(TileOwners::random_cut({}, 3, random), ::testing::SizeIs(2));
}

TEST(TileOwners, OwnersFollowTheCut) {
  const GridGeometry geometry{.cell_m = 1, .tile_bits = 0};
  const TileOwners owners(geometry,
                          {TileOwners::key(geometry, {2.5, 0.5}), TileOwners::key(geometry, {2.5, 0.5})});
  EXPECT_EQ(owners.ranks(), 3u);
  EXPECT_EQ(owners.owner({2.5, 0.5}), 2u);
  EXPECT_EQ(owners.owner({0.5, 0.5}), 0u);
}

/// Ranks that own a point within a distance of `point`, found by trying points.
std::vector<unsigned> owners_around(const TileOwners& owners, const Vec2& point, double distance) {
  std::vector<unsigned> near;
  for (double dy = -distance; dy <= distance; dy += distance / 16)
    for (double dx = -distance; dx <= distance; dx += distance / 16)
      if (std::hypot(dx, dy) <= distance) near.push_back(owners.owner(point + Vec2(dx, dy)));
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::erase(near, owners.owner(point));
  return near;
}

TEST(TileOwners, FindsAllRanksThatOwnTilesNearby) {
  const GridGeometry geometry{.cell_m = 0.5, .tile_bits = 2};
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed, stream_id("test", "owners"), 0, 0);
    const auto place = [&] { return Vec2(random.uniform(-20, 20), random.uniform(-20, 20)); };
    std::vector<TileOwners::Key> cut;
    for (int i = 0; i < 6; ++i) cut.push_back(TileOwners::key(geometry, place()));
    std::ranges::sort(cut);
    const TileOwners owners(geometry, cut);
    for (const double distance : {0.1, 3.0, 7.0}) {
      for (int i = 0; i < 40; ++i) {
        const Vec2 point = place();
        std::vector<unsigned> near;
        owners.find_near(point, distance, near);
        EXPECT_TRUE(std::ranges::is_sorted(near));
        EXPECT_EQ(std::ranges::adjacent_find(near), near.end());
        EXPECT_THAT(near, Not(Contains(owners.owner(point))));
        for (const unsigned rank : owners_around(owners, point, distance)) EXPECT_THAT(near, Contains(rank));
        found += near.size();
        // No rank is found whose tiles are all farther away: a larger distance finds more.
        std::vector<unsigned> farther;
        owners.find_near(point, distance + 3, farther);
        for (const unsigned rank : near) EXPECT_THAT(farther, Contains(rank));
      }
    }
  }
  EXPECT_GT(found, 500u);
}

/// The distance from a point to the nearest tile of each rank, m; infinity if it exceeds `distance`.
/// `tile_m`: edge of a tile, m
std::vector<double> distances_of_ranks(const TileOwners& owners, double tile_m, const Vec2& point,
                                       double distance) {
  std::vector<double> nearest(owners.ranks(), std::numeric_limits<double>::infinity());
  const Vec2 edges(tile_m, tile_m);
  for (double y = std::floor((point.y() - distance) / tile_m); y * tile_m <= point.y() + distance; ++y)
    for (double x = std::floor((point.x() - distance) / tile_m); x * tile_m <= point.x() + distance; ++x) {
      const Vec2 low(x * tile_m, y * tile_m);
      const double to_tile = (point.cwiseMax(low).cwiseMin(low + edges) - point).norm();
      double& least = nearest[owners.owner(low + 0.5 * edges)];
      if (to_tile <= distance) least = std::min(least, to_tile);
    }
  return nearest;
}

// If bodies far away count, the tiles near a point are many, but ranks that are too far away are not found.
TEST(TileOwners, DistantRanksAreFoundToWithinATenth) {
  const GridGeometry geometry{.cell_m = 0.5, .tile_bits = 2};
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed, stream_id("test", "distant owners"), 0, 0);
    const auto place = [&] { return Vec2(random.uniform(-700, 700), random.uniform(-700, 700)); };
    std::vector<TileOwners::Key> keys;
    for (int i = 0; i < 200; ++i) keys.push_back(TileOwners::key(geometry, place()));
    std::ranges::sort(keys);
    const TileOwners owners(geometry, TileOwners::random_cut(keys, 12, random));
    for (const double distance : {60.0, 130.0, 300.0}) {
      const Vec2 point = place();
      std::vector<unsigned> near;
      owners.find_near(point, distance, near);
      EXPECT_TRUE(std::ranges::is_sorted(near));
      EXPECT_EQ(std::ranges::adjacent_find(near), near.end());
      EXPECT_THAT(near, Not(Contains(owners.owner(point))));
      const std::vector<double> nearest = distances_of_ranks(owners, 2, point, 1.2 * distance);
      const double most = distance < 64 ? distance + 1e-3 : 1.1 * distance;
      for (unsigned rank = 0; rank < owners.ranks(); ++rank) {
        if (rank == owners.owner(point)) continue;
        const bool is_near = std::ranges::binary_search(near, rank);
        if (nearest[rank] <= distance) {
          EXPECT_TRUE(is_near) << "rank " << rank << " at " << nearest[rank] << " m, seed " << seed;
        } else if (nearest[rank] > most) {
          EXPECT_FALSE(is_near) << "rank " << rank << " at " << nearest[rank] << " m, seed " << seed;
        }
      }
      found += near.size();
    }
  }
  EXPECT_GT(found, 12u);
}

TEST(TileOwners, AllRanksAreNearIfTheDistanceIsHuge) {
  const TileOwners owners(GridGeometry{.cell_m = 1, .tile_bits = 0}, {5, 5, 1000});
  std::vector<unsigned> near;
  owners.find_near({0, 0}, 1e9, near);
  EXPECT_EQ(near.size(), 3u);
}

}  // namespace
}  // namespace troupe::partition::tile_owners_test
