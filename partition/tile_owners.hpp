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

/// Divides the plane among ranks (the threads or processes that compute one world together). The plane is
/// divided into square tiles, and the tiles are numbered along a Hilbert curve, so that tiles with near
/// numbers are near in space. The number of a tile is called its key. Each rank owns the tiles of one range
/// of keys. The list of the keys at which the ranges begin, without that of rank 0, is called the cut.
class TileOwners {
 public:
  using Key = std::uint64_t;  ///< number of a tile along the Hilbert curve

  TileOwners() = default;  ///< a single rank, which owns all tiles
  /// geometry: the grid, which gives the size of the tiles. cut: for N ranks, N - 1 keys in ascending order.
  /// Rank r owns the tiles with keys from cut[r - 1] (rank 0: from 0) up to, but not including, cut[r] (the
  /// last rank: up to the last key). Rank r owns nothing if cut[r - 1] and cut[r] are equal.
  TileOwners(const GridGeometry& geometry, std::vector<Key> cut);

  /// The key of a tile.
  static Key key(Cell tile);
  /// The key of the tile that contains a point (m, world frame).
  static Key key(const GridGeometry& geometry, const Vec2& point) {
    return key(geometry.tile(geometry.cell(point)));
  }
  /// Returns the cut (see the constructor) that gives each of `ranks` ranks about the same number of points,
  /// such as positions of robots. keys: for each point, the key of the tile that contains the point, in
  /// ascending order. Points with equal keys belong to one rank.
  static std::vector<Key> equal_cut(std::span<const Key> keys, unsigned ranks);

  /// For tests: returns a random cut (see the constructor). Each of its keys is a key of the ascending list
  /// `keys`, or such a key plus 1. With such a cut, many ranks own only one tile or no tile.
  static std::vector<Key> random_cut(std::span<const Key> keys, unsigned ranks, Random& random);

  unsigned ranks() const { return static_cast<unsigned>(cut_.size()) + 1; }  ///< number of ranks
  /// The rank that owns the tile that contains a point (m, world frame).
  unsigned owner(const Vec2& point) const { return owner(key(geometry_, point)); }

  /// Appends to `near` the ranks that own a tile within `distance` (m) of a point (m, world frame), in
  /// ascending order, without the owner of the point. May also append ranks whose tiles are slightly farther
  /// away; if `distance` is 32 tile edges or more, they are up to a tenth of `distance` farther away. If
  /// `distance` is 2^20 tile edges or more, appends all ranks but the owner. The result depends only on the
  /// arguments of the constructor and of this function, so that it is the same on all ranks. Not thread-safe.
  void find_near(const Vec2& point, double distance, std::vector<unsigned>& near) const;

 private:
  /// A square of 2^level by 2^level tiles. Square (0, 0) has its lower left corner at the origin of the world
  /// frame. The tiles of a square have successive keys.
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
