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

/// Circles that are consecutive in memory. Each circle encloses a body or a piece (a short chain of edges) of
/// a static outline. Three more circles must be readable beyond the end of the span, because SIMD loops load
/// up to four circles at a time.
using CircleRun = std::span<const BodyCircle>;
/// Copies the circles of all runs, one after another, to the entries of `out` from index `size` on. Sets the
/// bits of `mark` in the member `row` of each copy. `out` must have room for three more circles than are
/// copied, because SIMD loops store up to four circles at a time.
void unpack(std::span<const CircleRun> runs, std::uint32_t mark, std::size_t size, CircleArrays& out);

/// Finds the circles that the rays of range sensors may hit. Each circle encloses a body or a piece (a short
/// chain of edges) of a static outline. One search serves all sensors in a block. A block is a square of up
/// to 4 x 4 cells of the spatial index (GridGeometry::block_bits()).
///
/// The circles are divided into bands by their distance from the block. Band 0 is the nearest; in a crowd,
/// most sensors need only this band. Where there are few circles, band 0 is wider, so that a search of it is
/// worth its fixed cost. The circles of a band are searched for when the band is used for the first time. A
/// wide body (wider than a cell) may be in several bands, and several times in one band.
///
/// Call begin() after the bodies have moved, set_block_of() for each sensor, and then band() for the bands
/// from 0 on until farther circles are not needed. Sensors of different types in one block share a search as
/// well, if their reach is the same.
class NearbyOutlines {
 public:
  /// A bit of the member `row` of circles(). If it is set, the other bits are the number of a piece of a
  /// static outline. Otherwise `row` is the index of a body in the state tables.
  static constexpr std::uint32_t k_fixed = 1u << 31;

  /// Sets the spatial indexes to search: `bodies` for bodies and `fixed` for static outlines. Both must stay
  /// valid until the next begin(). If all arguments are the same as in the last call, and `bodies` was not
  /// rebuilt since, the circles that were found for the current block are kept.
  /// reach   largest distance from a sensor at which its rays may hit a circle, metres
  void begin(const BodyIndex& bodies, const FixedOutlines& fixed, double reach);
  /// Makes the block that contains this point (world frame, metres) the current block. The functions below
  /// refer to the current block. If the block changes, band() searches for the circles of all bands again.
  /// Call begin() first.
  void set_block_of(const Vec2& point);

  /// Number of bands. Together they contain every circle whose distance from the current block is at most the
  /// argument `reach` of begin(), and some farther circles. Call band(0) first.
  std::size_t bands() const { return radii_.size() - joined_; }
  /// The outer radius of a band, metres. Each circle whose distance from the current block is less than this
  /// radius is in this band or in an earlier one. The outer radius of the last band is the argument `reach`
  /// of begin(). Call band(0) first.
  double radius(std::size_t band) const { return radii_[joined_ + band]; }
  /// The circles of a band: a range of indices in circles(). The range is padded to a multiple of
  /// k_circle_padding with circles that no beam hits.
  struct Band {
    std::size_t begin;  ///< index of the first circle of the band
    std::size_t end;    ///< one past the index of the last circle
  };
  /// Returns the range of a band in circles(). `band` is the number of the band, below bands(). The first
  /// call for a band searches for the circles of this band and of all earlier bands. set_block_of() must have
  /// been called since begin().
  Band band(std::size_t band) {
    while (ends_.size() <= band) gather(ends_.size());
    return {band == 0 ? 0 : ends_[band - 1], ends_[band]};
  }
  /// The circles that band() has found so far, world frame, metres. Further calls of band() may add circles.
  const CircleArrays& circles() const { return circles_; }
  /// A distance from the sensor, metres. The sensor should first examine the circles of band 0 that are
  /// within this distance, and then the other circles of band 0. Hits on the first circles shorten the beams,
  /// so that fewer of the other circles must be examined. On average about k_nearest_shell_circles circles
  /// are within this distance. It is at most radius(0), or infinite if band 0 has so few circles that
  /// examining all of them at once is faster. Call band(0) first.
  double nearest_shell_m() const { return nearest_shell_m_; }
  static constexpr double k_nearest_shell_circles = 20;  ///< mean number of circles within nearest_shell_m()
  /// nearest_shell_m() is infinite if band 0 has at most this many circles.
  static constexpr double k_most_in_one_search = 48;
  /// Band 0 has at least this many circles, unless there are fewer within the reach.
  static constexpr std::size_t k_least_in_band_0 = 32;

 private:
  void gather(std::size_t band);

  const BodyIndex* bodies_ = nullptr;
  std::uint64_t version_ = 0;  // of *bodies_; 0: it was never built
  const FixedOutlines* fixed_ = nullptr;
  double reach_ = 0;
  double nearest_shell_m_ = 0;
  std::vector<double> radii_;  // outer radii of rings: band 0 of a block consists of one or several rings
  std::size_t joined_ = 0;     // number of rings of band 0 of the current block, minus 1
  std::optional<Cell> home_;   // the current block
  std::array<CircleRun, 64> runs_;  // runs that were found but not yet unpacked
  CircleArrays circles_;
  std::vector<std::size_t> ends_;  // ends of the bands gathered so far
};

}  // namespace troupe::partition
