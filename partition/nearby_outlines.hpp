#pragma once

#include "partition/body_index.hpp"
#include "partition/fixed_outlines.hpp"
#include "partition/near_circles.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace troupe::partition {

/// Circles that enclose bodies or static outlines, consecutive in memory. Three more circles must be readable
/// beyond the end, because kernels load several circles at a time.
using CircleRun = std::span<const BodyCircle>;
/// Copies the circles of all runs, one after another, to the entries of `out` from index `size` on. `out` has
/// one array for each member of a circle. In the copies, the bits of `mark` are set in the member `row` (the
/// index of a body or the number of an outline piece). `out` must have room for three more circles than are
/// copied.
void unpack(std::span<const CircleRun> runs, std::uint32_t mark, std::size_t size, CircleArrays& out);

/// Finds the outlines that the rays of the sensors in one block may hit, and gives the circles that enclose
/// these outlines. A block is a square of up to 4 x 4 cells of the spatial index
/// (GridGeometry::block_bits()). The outlines are those of bodies, and pieces (short chains of edges) of
/// static outlines. The circles are divided into bands by their distance from the block; band 0 is the
/// nearest. A wide body (wider than a cell) may be in several bands, and several times in one band. A band is
/// gathered on first use and then serves all sensors in the block. In a crowd most sensors need only the
/// first band.
class NearbyOutlines {
 public:
  /// In circles(), the member `row` is the index of a body in the state tables or, with this bit set, the
  /// number of a piece of a static outline.
  static constexpr std::uint32_t k_fixed = 1u << 31;

  /// Sets the two spatial indexes to search, which must stay valid during the queries, and forgets the
  /// current block. geometry: the grid of `bodies`, which defines the blocks. reach: largest distance from a
  /// sensor at which its rays may hit a circle, metres.
  void begin(const BodyIndex& bodies, const FixedOutlines& fixed, const GridGeometry& geometry, double reach);
  /// Makes the block that contains this point (world frame, metres) the current block, to which the functions
  /// below refer. If the block changes, all bands are gathered again on their next use. begin() must have
  /// been called.
  void set_block_of(const Vec2& point);

  /// Number of bands. Together they contain every circle within the reach of any point of the block, and some
  /// that are farther away.
  std::size_t bands() const { return radii_.size(); }
  /// The outer radius of a band, metres: every circle closer than this to any point of the block is in this
  /// band or an earlier one. The outer radius of the last band is the argument `reach` of begin().
  double radius(std::size_t band) const { return radii_[band]; }
  /// The range of a band in circles(). Bands are padded to a multiple of k_circle_padding with circles that
  /// no beam hits.
  struct Band {
    std::size_t begin;  ///< index of its first circle in circles()
    std::size_t end;    ///< index one past its last circle
  };
  /// Returns the range of the band with this number, which must be below bands(). Gathers this band and all
  /// earlier ones on first use. set_block_of() must have been called since begin().
  Band band(std::size_t band) {
    while (ends_.size() <= band) gather(ends_.size());
    return {band == 0 ? 0 : ends_[band - 1], ends_[band]};
  }
  /// The circles of all bands gathered so far, world frame; grows when the next band is gathered.
  const CircleArrays& circles() const { return circles_; }
  /// The distance from a sensor, metres, up to which the sensor should search the first band before it
  /// searches the rest of that band. On average about k_nearest_shell_circles circles are within this
  /// distance. It is at most radius(0). It is infinite if the first band has so few circles that a single
  /// search is faster. Valid once the first band has been gathered.
  double nearest_shell_m() const { return nearest_shell_m_; }
  static constexpr double k_nearest_shell_circles = 20;  ///< mean number of circles within nearest_shell_m()
  /// nearest_shell_m() is infinite if the first band has at most this many circles.
  static constexpr double k_most_in_one_search = 48;

 private:
  void gather(std::size_t band);

  const BodyIndex* bodies_ = nullptr;
  const FixedOutlines* fixed_ = nullptr;
  GridGeometry geometry_;
  double reach_ = 0;
  double nearest_shell_m_ = 0;
  std::vector<double> radii_;
  std::optional<Cell> home_;        // the current block
  std::array<CircleRun, 64> runs_;  // runs that were found but not yet unpacked
  CircleArrays circles_;
  std::vector<std::size_t> ends_;  // ends of the bands gathered so far
};

}  // namespace troupe::partition
