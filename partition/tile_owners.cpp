#include "partition/tile_owners.hpp"

#include <algorithm>
#include <utility>

namespace troupe::partition {
namespace {

// Margin for the rounding of the bounds of a tile, m.
constexpr double k_slack_m = 1e-6;
// From this distance on, in tiles, all ranks count as near. Squares as wide as such a distance could have
// corners that Cell cannot represent.
constexpr double k_most_tiles = 1 << 20;
// From this distance on, in squares, find_near() uses wider squares. Otherwise, the search for the ground of
// other ranks near each tile would take long, and the lists of this ground would take much memory.
constexpr double k_most_squares = 32;

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

/// The lowest key of a tile of a square.
TileOwners::Key TileOwners::first_key(const Square& square) {
  const std::int32_t edge = 1 << square.level;
  return key(Cell{square.x * edge, square.y * edge}) & ~(number_of_tiles(square) - 1);
}

/// Edge of a square of this level, m.
double TileOwners::edge_m(unsigned level) const {
  return geometry_.tile_m() * static_cast<double>(1u << level);
}

Box TileOwners::box_of(const Square& square) const {
  const double edge = edge_m(square.level);
  Box box;
  box.min = Vec2(square.x * edge, square.y * edge);
  box.max = Vec2((square.x + 1.0) * edge, (square.y + 1.0) * edge);
  return box;
}

/// The ground within `distance` (m) of a point of `square` that belongs to other ranks than `own`, as squares
/// sorted by their ranks. Some of them are farther away. The squares have at least the level of `square`: a
/// square of that level is in the list once for each rank that owns a tile of it. The result is cached until
/// `distance` changes.
const std::vector<TileOwners::Foreign>& TileOwners::foreign_near(const Square& square, unsigned own,
                                                                 double distance) const {
  if (distance != distance_) {
    foreign_.clear();
    distance_ = distance;
  }
  const auto [found, is_new] = foreign_.try_emplace({first_key(square), own});
  std::vector<Foreign>& list = found->second;
  if (!is_new) return list;
  // A square that is at least as wide as the distance, and its eight neighbours, contain all this ground.
  unsigned up = 0;
  while (edge_m(square.level + up) < distance) ++up;
  const Box from = box_of(square).expanded(distance);
  for (const std::int32_t dy : {-1, 0, 1})
    for (const std::int32_t dx : {-1, 0, 1})
      add_foreign({(square.x >> up) + dx, (square.y >> up) + dy, square.level + up}, square.level, own, from,
                  list);
  std::ranges::stable_sort(list, {}, &Foreign::rank);
  return list;
}

/// Adds the parts of a square that touch the box `near` and belong to other ranks than `own`. A square of
/// several ranks is divided into four, but not below `least_level`.
void TileOwners::add_foreign(const Square& square, unsigned least_level, unsigned own, const Box& near,
                             std::vector<Foreign>& found) const {
  const Box box = box_of(square);
  if (!box.touches(near)) return;
  const Key first = first_key(square);
  const unsigned lowest = owner(first);
  const unsigned highest = owner(first + (number_of_tiles(square) - 1));
  if (lowest != highest && square.level > least_level) {
    for (const std::int32_t dy : {0, 1})
      for (const std::int32_t dx : {0, 1})
        add_foreign({2 * square.x + dx, 2 * square.y + dy, square.level - 1}, least_level, own, near, found);
    return;
  }
  for (unsigned rank = lowest;; rank = owner(cut_[rank])) {  // the next rank that owns a tile
    if (rank != own) found.push_back({box, rank});
    if (rank == highest) return;
  }
}

void TileOwners::find_near(const Vec2& point, double distance, std::vector<unsigned>& near) const {
  const unsigned own = owner(point);
  if (!(distance < k_most_tiles * geometry_.tile_m())) {
    for (unsigned rank = 0; rank < ranks(); ++rank)
      if (rank != own) near.push_back(rank);
    return;
  }
  unsigned level = 0;
  while (distance >= k_most_squares * edge_m(level)) ++level;
  const Cell tile = geometry_.tile(geometry_.cell(point));
  const std::size_t before = near.size();
  const double reach = distance + k_slack_m;
  for (const Foreign& foreign : foreign_near({tile.x >> level, tile.y >> level, level}, own, reach))
    if ((near.size() == before || near.back() != foreign.rank) &&
        distance2(foreign.box, point) <= reach * reach)
      near.push_back(foreign.rank);
}

}  // namespace troupe::partition
