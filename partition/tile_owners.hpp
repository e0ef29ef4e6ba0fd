#pragma once

#include "base/geometry.hpp"
#include "base/random.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace troupe::partition {

/// Divides the plane among ranks (the threads or processes that compute one world together). The plane is cut
/// into square tiles, and the tiles are numbered along a Hilbert curve, so that tiles with near numbers are
/// near in space. Each rank owns the tiles of one range of numbers.
class TileOwners {
 public:
  using Key = std::uint64_t;  ///< number of a tile along the Hilbert curve

  TileOwners() = default;  ///< a single rank, which owns all tiles
  /// cut: for N ranks, N - 1 keys in ascending order. Rank r owns the tiles with keys from cut[r - 1] (rank
  /// 0: from 0) up to, but not including, cut[r] (the last rank: up to the last key). Rank r owns nothing if
  /// cut[r - 1] and cut[r] are equal.
  TileOwners(const GridGeometry& geometry, std::vector<Key> cut);

  /// The key of a tile.
  static Key key(Cell tile);
  /// The key of the tile that contains a point (m, world frame).
  static Key key(const GridGeometry& geometry, const Vec2& point) {
    return key(geometry.tile(geometry.cell(point)));
  }
  /// Returns the cut (see the constructor) that gives each of `ranks` ranks about the same number of points.
  /// keys: the key of each point's tile, in ascending order. Points with equal keys have one owner.
  static std::vector<Key> equal_cut(std::span<const Key> keys, unsigned ranks);

  /// For tests: returns a random cut (see the constructor). Each of its keys is a key of the ascending list
  /// `keys`, or such a key plus 1. With such a cut, many ranks own only one tile or no tile.
  static std::vector<Key> random_cut(std::span<const Key> keys, unsigned ranks, Random& random);

  unsigned ranks() const { return static_cast<unsigned>(cut_.size()) + 1; }  ///< number of ranks
  /// The rank that owns the tile that contains a point (m, world frame).
  unsigned owner(const Vec2& point) const { return owner(key(geometry_, point)); }

  /// Appends to `near` the ranks that own a tile within `distance` (m) of a point (m, world frame), in
  /// ascending order, without the owner of the point. May also append ranks whose tiles are slightly farther
  /// away. If the distance is 128 tile edges or more, appends all ranks but the owner. The result depends
  /// only on the arguments of the constructor and of this function, so that it is the same on all ranks. Not
  /// thread-safe.
  void find_near(const Vec2& point, double distance, std::vector<unsigned>& near) const;

 private:
  struct Foreign {  // a tile of another rank
    Box box;
    unsigned rank;
  };
  unsigned owner(Key key) const;
  Box box_of(Cell tile) const;
  const std::vector<Foreign>& foreign_near(Cell tile, double distance) const;

  GridGeometry geometry_;
  std::vector<Key> cut_;
  // Tiles of other ranks near the tiles that find_near() was asked about with the last distance.
  mutable double distance_ = -1;
  mutable std::map<Key, std::vector<Foreign>> foreign_;
};

}  // namespace troupe::partition
