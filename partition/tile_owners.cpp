#include "partition/tile_owners.hpp"

#include <algorithm>
#include <utility>

namespace troupe::partition {
namespace {

// Margin for the rounding of the bounds of a tile, m.
constexpr double k_slack_m = 1e-6;
// Beyond this distance, in tiles, all ranks count as near: the loop over tiles would take too long.
constexpr double k_most_tiles = 128;

double distance2(const Box& box, const Vec2& point) {
  const Vec2 nearest = point.cwiseMax(box.min).cwiseMin(box.max);
  return (point - nearest).squaredNorm();
}

}  // namespace

TileOwners::TileOwners(const GridGeometry& geometry, std::vector<Key> cut)
    : geometry_(geometry), cut_(std::move(cut)) {}

/// The usual conversion of coordinates into the distance along a Hilbert curve of order 32 (Skilling,
/// "Programming the Hilbert curve", AIP 2004, describes the method for any number of dimensions).
TileOwners::Key TileOwners::key(Cell tile) {
  auto x = static_cast<std::uint32_t>(tile.x) ^ 0x80000000u;  // in the order of the signed numbers
  auto y = static_cast<std::uint32_t>(tile.y) ^ 0x80000000u;
  Key key = 0;
  for (std::uint32_t s = 0x80000000u; s > 0; s >>= 1) {
    const bool right = (x & s) != 0;
    const bool upper = (y & s) != 0;
    key = key << 2 | (right ? (upper ? 2u : 3u) : (upper ? 1u : 0u));
    if (upper) continue;
    if (right) {
      x = ~x;
      y = ~y;
    }
    std::swap(x, y);
  }
  return key;
}

std::vector<TileOwners::Key> TileOwners::equal_cut(std::span<const Key> keys, unsigned ranks) {
  std::vector<Key> cut;
  for (unsigned rank = 1; rank < ranks; ++rank)
    cut.push_back(keys.empty() ? 0 : keys[keys.size() * rank / ranks]);
  return cut;
}

std::vector<TileOwners::Key> TileOwners::random_cut(std::span<const Key> keys, unsigned ranks,
                                                    Random& random) {
  std::vector<Key> cut;
  while (cut.size() + 1 < ranks) {
    const Key key = keys.empty() ? 0 : keys[random.below(static_cast<std::uint32_t>(keys.size()))];
    cut.push_back(key);
    if (cut.size() + 1 == ranks) break;
    // The next rank begins at `key`. If `next` is 0, the rank after it also begins at `key`, so the first of
    // the two owns no tile. If `next` is 1, the rank after it begins at key + 1, so the first of the two owns
    // only the tile of `key`. Otherwise the first of the two may own any number of tiles.
    if (const std::uint32_t next = random.below(4); next < 2) cut.push_back(key + next);
  }
  std::ranges::sort(cut);
  return cut;
}

unsigned TileOwners::owner(Key key) const {
  return static_cast<unsigned>(std::ranges::upper_bound(cut_, key) - cut_.begin());
}

Box TileOwners::box_of(Cell tile) const {
  const double edge = geometry_.tile_m();
  Box box;
  box.min = Vec2(tile.x * edge, tile.y * edge);
  box.max = Vec2((tile.x + 1.0) * edge, (tile.y + 1.0) * edge);
  return box;
}

/// The tiles that do not belong to the owner of `tile` and that may be within `distance` (m) of a point of
/// `tile`, sorted by their owners. Some of them are farther away. The result is cached for each tile until
/// `distance` changes.
const std::vector<TileOwners::Foreign>& TileOwners::foreign_near(Cell tile, double distance) const {
  if (distance != distance_) {
    foreign_.clear();
    distance_ = distance;
  }
  const auto [found, is_new] = foreign_.try_emplace(key(tile));
  if (!is_new) return found->second;
  const unsigned own = owner(found->first);
  const auto tiles = static_cast<std::int32_t>(distance / geometry_.tile_m()) + 1;
  for (std::int32_t y = tile.y - tiles; y <= tile.y + tiles; ++y)
    for (std::int32_t x = tile.x - tiles; x <= tile.x + tiles; ++x)
      if (const unsigned rank = owner(key(Cell{x, y})); rank != own)
        found->second.push_back({box_of({x, y}), rank});
  std::ranges::stable_sort(found->second, {}, &Foreign::rank);
  return found->second;
}

void TileOwners::find_near(const Vec2& point, double distance, std::vector<unsigned>& near) const {
  const Cell tile = geometry_.tile(geometry_.cell(point));
  if (!(distance < k_most_tiles * geometry_.tile_m())) {
    const unsigned own = owner(point);
    for (unsigned rank = 0; rank < ranks(); ++rank)
      if (rank != own) near.push_back(rank);
    return;
  }
  const std::size_t before = near.size();
  const double reach = distance + k_slack_m;
  for (const Foreign& foreign : foreign_near(tile, reach))
    if ((near.size() == before || near.back() != foreign.rank) &&
        distance2(foreign.box, point) <= reach * reach)
      near.push_back(foreign.rank);
}

}  // namespace troupe::partition
