#pragma once

#include "base/geometry.hpp"
#include "base/random.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace troupe::partition {

/// Divides the plane among ranks. Ranks are the threads or processes that compute one world together.
///
/// The plane consists of square tiles, which are numbered along a Hilbert curve. Tiles with near numbers are
/// therefore near in space. The number of a tile is called its key. Each rank owns the tiles whose keys are
/// in one interval. The list of the keys at which the intervals of the ranks 1, 2, ... begin is called the
/// cut.
class TileOwners {
 public:
  using Key = std::uint64_t;  ///< number of a tile along the Hilbert curve

  TileOwners() = default;  ///< a single rank, which owns all tiles
  /// geometry: the grid, which gives the size of the tiles. cut: N - 1 keys for N ranks, in ascending order.
  ///
  /// Rank r owns the tiles with keys from cut[r - 1] to cut[r] - 1. The interval of rank 0 begins at key 0,
  /// and the interval of the last rank ends at the highest key. For example, the cut {100, 250} gives rank 0
  /// the keys 0 to 99, rank 1 the keys 100 to 249, and rank 2 all higher keys. A rank owns no tile if its
  /// interval is empty, as with equal elements in the cut.
  TileOwners(const GridGeometry& geometry, std::vector<Key> cut);

  /// Returns the key of a tile. tile: column and row of the tile, as GridGeometry::tile() returns them.
  static Key key(Cell tile);
  /// Returns the key of the tile that contains a point (m, world frame).
  static Key key(const GridGeometry& geometry, const Vec2& point) {
    return key(geometry.tile(geometry.cell(point)));
  }
  /// Returns a cut that gives each of `ranks` ranks about the same number of points, such as positions of
  /// robots. keys: for each point, the key of its tile, in ascending order. All points in one tile go to one
  /// rank.
  static std::vector<Key> equal_cut(std::span<const Key> keys, unsigned ranks);

  /// For tests: returns a random cut with small intervals, so that many ranks own no tile or only one tile.
  /// Each element of the cut is an element of `keys` or 1 more. `keys` must be in ascending order.
  static std::vector<Key> random_cut(std::span<const Key> keys, unsigned ranks, Random& random);

  unsigned ranks() const { return static_cast<unsigned>(cut_.size()) + 1; }  ///< number of ranks
  /// Returns the rank that owns the tile that contains a point (m, world frame).
  unsigned owner(const Vec2& point) const { return owner(key(geometry_, point)); }

  /// Appends to `near` the ranks that own a tile within `distance` (m) of a point (m, world frame), in
  /// ascending order. The owner of the point is omitted.
  ///
  /// The result can also contain ranks whose nearest tile is slightly farther away: up to 1.1 times
  /// `distance` plus 1e-6 m. If `distance` is 2^20 tile edges or more, the result contains all ranks except
  /// the owner. Objects with equal constructor arguments return equal results. Not thread-safe.
  void find_near(const Vec2& point, double distance, std::vector<unsigned>& near) const;

 private:
  /// A square of 2^level by 2^level tiles. x and y are its column and row in the grid of all squares of this
  /// level: square (0, 0) has its lower left corner at the origin of the world frame. The keys of the tiles
  /// of a square are successive.
  struct Square {
    std::int32_t x;
    std::int32_t y;
    unsigned level;
  };
  struct Foreign {  // tiles of another rank
    Box box;
    unsigned rank;
  };
  static Key number_of_tiles(const Square& square) { return Key{1} << (2 * square.level); }
  static Key first_key(const Square& square);
  unsigned owner(Key key) const;
  double edge_m(unsigned level) const;
  Box box_of(const Square& square) const;
  const std::vector<Foreign>& foreign_near(const Square& square, unsigned own, double distance) const;
  void add_foreign(const Square& square, unsigned least_level, unsigned own, const Box& near,
                   std::vector<Foreign>& found) const;

  GridGeometry geometry_;
  std::vector<Key> cut_;
  // Cache of find_near() for the last value of `distance`: tiles of other ranks near a square. The key of an
  // element is the first key of the square, and the rank that owns the point.
  mutable double distance_ = -1;
  mutable std::map<std::pair<Key, unsigned>, std::vector<Foreign>> foreign_;
};

}  // namespace troupe::partition
