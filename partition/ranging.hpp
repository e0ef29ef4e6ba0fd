#pragma once

#include "base/pose.hpp"
#include "partition/nearby_outlines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>

namespace troupe::partition {

/// The arithmetic of the exact ray engine, which computes where the beams of range sensors hit the edges of
/// outlines. docs/sensing.md derives the formulas and their error bounds. Units are metres; inverse ranges
/// are in 1/m.
///
/// Terms:
/// - Fan: a set of beams at one height that are computed together.
/// - Reference point of a fan: a point near the origins of its beams, to which positions are relative.
/// - Range: the distance along a beam from its origin to a hit. Inverse range: 1 / range; 0 if there is no
///   hit.
/// - To project an edge on a fan: to compute the inverse ranges at which the beams of the fan hit the edge.
/// - Kernel: a SIMD loop that is compiled for several instruction sets.
///
/// Formulas. A beam has the origin o and the unit direction d. An edge runs from a to b, and e = b - a.
/// Positions are relative to the reference point; x denotes the cross product in the plane.
/// - The sign of c_a = (a - o) x d tells on which side of the beam the vertex a is. The sign of
///   c_b = (b - o) x d tells this for the vertex b. The line through the beam crosses the edge if the two
///   signs differ. A zero counts as either sign, so that no beam passes between two edges at their common
///   vertex.
/// - The inverse range is (d x e) / A, with A = (a - o) x (b - o). It is negative if the edge is behind the
///   origin of the beam.
///
/// Rounding. Vertices relative to the reference point are computed in double and rounded once to float. Two
/// edges with a common vertex use the same value, so they agree on its side. The values e and a x b are also
/// computed in double and then rounded to float. They are not computed from the rounded a and b, because this
/// would lose all digits for an edge that is short compared to its distance. (For an edge of 5 mm at 5 m, the
/// error of the range would be 0.3 mm.)
///
/// Special cases. In two cases, the formula for the inverse range would divide rounding errors by rounding
/// errors:
/// - The beam hits the edge at a grazing angle: |d x e| < 2^-8 (|ex| + |ey|), see k_grazing.
/// - The edge looks tiny from the origin of the beam, or passes very near this origin: |A| <= 2^-20 m^2, see
///   k_tiny. Here m is the sum of the magnitudes of the coordinates of a, b and o.
///
/// In these cases, too, the signs of c_a and c_b decide whether the beam hits the edge, but the range is
/// computed in double. It is then clamped to the distances along the beam that the edge spans. A beam that
/// starts on an edge hits the edge, whatever the direction of the beam.

/// Arrays of beams are padded to a multiple of this number. It is the largest number of beams that a kernel
/// processes at a time.
inline constexpr std::size_t k_beam_padding = 16;
/// The size of an array for `count` beams, padding included.
constexpr std::size_t padded_beams(std::size_t count) {
  return (count + k_beam_padding - 1) / k_beam_padding * k_beam_padding;
}

/// The geometry of a scan. A scan is a fan whose beams have one origin and equal angular steps, in
/// counter-clockwise order, such as the beams of a laser scanner. It may have more than k_most_beams beams.
struct Scan {
  Vec2 middle = Vec2::UnitX();  ///< unit vector halfway between first and last beam, world frame
  float fov = 0;                ///< angle between the first and the last beam, rad
  float step = 0;               ///< angle between neighbouring beams, rad
};

/// The largest number of beams of a fan that is not a scan.
inline constexpr std::size_t k_most_beams = 32;

/// A fan: beams at one height that are computed together. Beam i starts at (ox[i], oy[i]), relative to the
/// reference point, and has the unit direction (dx[i], dy[i]). Both vectors are along the axes of the world
/// frame. Functions take the reference point as a separate argument. Each array has padded() entries; the
/// entries from `count` on repeat the last beam.
struct Fan {
  const float* dx = nullptr;   ///< x of the directions
  const float* dy = nullptr;   ///< y of the directions
  const float* ox = nullptr;   ///< x of the origins, m
  const float* oy = nullptr;   ///< y of the origins, m
  std::size_t count = 0;       ///< number of beams
  bool common_origin = false;  ///< true: all beams start at the reference point
  bool mirrored = false;       ///< true: for i < count / 2, beams i and i + count / 2 are opposite
  const Scan* scan = nullptr;  ///< not null if the beams form a scan

  std::size_t padded() const { return padded_beams(count); }  ///< size of each array
};

/// An edge from a to b, relative to the reference point of the fan, metres.
struct RayEdge {
  float ax;    ///< x of the start a
  float ay;    ///< y of the start a
  float bx;    ///< x of the end b
  float by;    ///< y of the end b
  float ex;    ///< x of b - a, rounded once
  float ey;    ///< y of b - a, rounded once
  float area;  ///< a x b, rounded once; exactly 0 if the edge's line passes through the reference point
  float ranger_return;  ///< intensity that a beam reads if it hits the edge
};

/// A margin, as a fraction of a distance, by which tests for distant edges lengthen each beam. The tests
/// discard edges that a beam cannot reach. Without the margin, they could discard an edge whose computed
/// range is too small because of rounding.
///
/// Let r be the distance from the origin of the beam to the nearest point of the edge, and s the distance
/// from this origin to the reference point of the fan. The error of the range is largest at the smallest
/// angle that is not grazing (k_grazing), and is there at most 2^-14 (r + s). If s <= r, the margin is at
/// least twice this error.
constexpr double k_range_slack = 1.0 / 4096;

/// A second margin, metres, which is added to the margin of k_range_slack. It covers the rounding to float of
/// distances near 0.
constexpr float k_cull_slack = 1e-6f;

/// A beam hits an edge at a grazing angle if |d x e| is less than this number times |ex| + |ey|. The comment
/// at the top of this file defines d and e.
constexpr float k_grazing = 1.0f / 256;
/// An edge looks tiny from the origin of a beam, or passes very near this origin, if |A| is at most this
/// number times m^2. The comment at the top of this file defines A and m. The sign of A tells on which side
/// of the line of the edge the origin is. If |A| is so small, rounding may have changed this sign.
constexpr float k_tiny = 1.0f / (1 << 20);

/// Returns the edge from a to b relative to the reference point; the arguments are in the world frame,
/// metres. RayEdge::area is the difference of two products, ax by - ay bx. It is set to exactly 0 if its
/// magnitude is below the rounding errors of these products.
inline RayEdge relative_edge(const Vec2& a, const Vec2& b, const Vec2& reference, float ranger_return) {
  constexpr double k_noise = 0x1p-50;
  const Vec2 from = a - reference;
  const Vec2 to = b - reference;
  const double p = from.x() * to.y();
  const double q = from.y() * to.x();
  const bool on_line = std::abs(p - q) <= k_noise * (std::abs(p) + std::abs(q));
  RayEdge edge;
  edge.ax = static_cast<float>(from.x());
  edge.ay = static_cast<float>(from.y());
  edge.bx = static_cast<float>(to.x());
  edge.by = static_cast<float>(to.y());
  edge.ex = static_cast<float>(b.x() - a.x());
  edge.ey = static_cast<float>(b.y() - a.y());
  edge.area = on_line ? 0.0f : static_cast<float>(p - q);
  edge.ranger_return = ranger_return;
  return edge;
}

/// A set of beams of a fan: bit i is set if beam i is in the set. A scan may have more beams than the set has
/// bits. For a scan, functions therefore ignore the set and find the beams by their angles.
using BeamSet = std::uint32_t;
/// The set of all beams of a fan. A fan that is not a scan must have 1 to k_most_beams beams. For a scan, all
/// bits are set.
inline BeamSet all_beams(const Fan& fan) {
  return fan.scan != nullptr ? ~0u : ~0u >> (k_most_beams - fan.count);
}

/// A buffer of outlines that project() projects on a fan, world frame, metres. The buffer stores chains of
/// vertices, so that two edges share the work for their common vertex. Vertices are numbered over all chains,
/// and edge j runs from vertex j to vertex j + 1. The last vertex of a chain begins no edge. For example, a
/// chain of three edges and then a chain of two edges have the vertices 0 to 3 and 4 to 6. Their edges are 0,
/// 1, 2, 4 and 5.
class EdgeBlock {
 public:
  static constexpr std::size_t k_capacity = 128;  ///< largest number of vertices
  static constexpr std::size_t k_piece = 8;       ///< largest number of edges of a piece
  /// Consecutive edges of a chain, which kernels process together.
  struct Piece {
    std::uint32_t first;  ///< number of the vertex at which the first edge begins
    std::uint32_t edges;  ///< number of edges, at most k_piece
    BeamSet met_by;       ///< the beams that may hit one of the edges
    float ranger_return;  ///< intensity that beams read from the edges
  };

  /// Removes all vertices.
  void clear() { vertices_ = pieces_count_ = 0; }
  bool empty() const { return vertices_ == 0; }       ///< whether there are no vertices
  std::size_t vertices() const { return vertices_; }  ///< number of vertices of all chains
  /// The largest number of edges that the next chain may have; 0 if the buffer is full.
  std::size_t room() const { return std::max(vertices_, k_capacity - 1) - vertices_; }

  /// Adds a chain of edges, world frame, metres: the first edge runs from `first` to rest[0], the next one
  /// from rest[0] to rest[1], and so on. Divides the chain into pieces of at most k_piece edges.
  /// edges          number of edges, from 1 to room()
  /// rest           array of `edges` vertices. k_piece - 1 more vertices must be readable beyond its end,
  ///                because add() copies vertices in groups of k_piece
  /// ranger_return  intensity that beams read from the edges
  /// met_by         the beams that may hit one of the edges
  void add(const Vec2& first, const Vec2* rest, std::size_t edges, float ranger_return, BeamSet met_by) {
    double* out = &xy_[2 * vertices_];
    std::memcpy(out, first.data(), 2 * sizeof(double));
    std::size_t done = 0;
    do {
      // Copying the exact number of vertices would cost an unpredictable branch. The next piece overwrites
      // the excess.
      const std::size_t left = edges - done;
      std::memcpy(out + 2 + 2 * done, rest[done].data(), 2 * k_piece * sizeof(double));
      pieces_[pieces_count_++] = {static_cast<std::uint32_t>(vertices_ + done),
                                  static_cast<std::uint32_t>(std::min(left, k_piece)), met_by, ranger_return};
      done += k_piece;
    } while (done < edges);
    vertices_ += edges + 1;
  }

  // Kernels read whole vectors, also beyond the last vertex.
  const double* xy() const { return xy_.data(); }  ///< x and y of each vertex, aligned to 64 bytes
  /// The pieces in the order in which they were added.
  std::span<const Piece> pieces() const { return {pieces_.data(), pieces_count_}; }
  /// Edge j relative to the reference point (world frame, metres). Vertex j must not be the last of its
  /// chain. ranger_return: that of the piece to which the edge belongs.
  RayEdge relative(std::size_t j, const Vec2& reference, float ranger_return) const {
    const double* e = &xy_[2 * j];
    return relative_edge({e[0], e[1]}, {e[2], e[3]}, reference, ranger_return);
  }

 private:
  alignas(64) std::array<double, 2 * (k_capacity + 3 * k_piece)> xy_{};
  std::array<Piece, k_capacity> pieces_{};
  std::size_t vertices_ = 0;
  std::size_t pieces_count_ = 0;
};

/// Rotates the vectors (x[i], y[i]), which are directions or origins of beams, and writes the results to
/// out_x and out_y. Each result is rounded once to float. count: number of beams. All arrays have
/// padded_beams(count) entries.
void turn(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
          float* out_y);

/// Projects the edges on all beams of a fan. For each beam i, raises inverse[i] to the inverse range (1/m) of
/// the nearest hit on the edges, if this is larger than inverse[i]. If inverse[i] is 0 at first (no hit),
/// several calls therefore find the nearest hit on all their edges.
/// reference  the reference point of the fan, world frame, metres
/// inverse    array of fan.padded() entries
/// returns    null if it is not needed, else an array of fan.padded() entries. When inverse[i] is raised,
///            returns[i] is set to the ranger_return of the edge that is hit. Of two edges at the same range,
///            the larger ranger_return is used
void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse, float* returns);

/// Writes to limits[i] the distance, metres, beyond which edges cannot change the range of beam i. This is
/// the smaller of the range found so far (1 / inverse[i]) and range_max[i], plus the margins of k_range_slack
/// and k_cull_slack. Returns the largest entry of `limits`. All three arrays have fan.padded() entries.
float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits);

/// Computes the readings, metres: sets ranges[i] to range_of(inverse[i], range_max[i]). `ranges` has
/// fan.count entries; the other two arrays have fan.padded() entries.
void ranges_of(const Fan& fan, const float* inverse, const float* range_max, float* ranges);

/// The result of may_meet(), which selects the circles that some beam may hit. `row` and `beams` have one
/// entry for each selected circle. The entry of `row` is that of the circle (CircleArrays::row). The members
/// x, y and radius are working memory of may_meet().
struct MetCircles : CircleArrays {
  std::vector<BeamSet> beams;  ///< per circle: the beams that may hit it

  /// Ensures that the arrays have room for this many circles; keeps the contents.
  void change_capacity(std::size_t size) {
    CircleArrays::change_capacity(size);
    beams.resize(row.size());
  }
};

/// The arguments `begin` and `end` of may_meet() must be multiples of this number.
inline constexpr std::size_t k_circle_padding = 16;
/// Finds the circles that the beams of a fan may hit. Selects every circle whose distance from the reference
/// point is from `low` to `high` and which some beam hits within the limit of this beam. Writes the member
/// `row` of the selected circles, and the beams that may hit them, to the first entries of `met`. Returns the
/// number of selected circles. The tests have margins far above rounding errors, so some other circles are
/// selected too.
/// circles     the circles, world frame, metres; a circle with a radius of minus infinity is never selected
/// begin, end  the circles to test have the indices `begin` to `end` - 1 in `circles`; `begin` and `end` must
///             be multiples of k_circle_padding
/// reference   the reference point of the fan, world frame, metres
/// limits      array that limits_of() has written
/// low, high   bounds on the distance from the reference point to the nearest point of a circle, metres. If
///             the reference point is inside the circle, this distance is negative. `high` is not negative;
///             `low` may be minus infinity
std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const float* limits, float low, float high, MetCircles& met);

/// The inverse range, 1/m, at which one beam hits one edge: 0 if the beam misses the edge, infinity if the
/// beam starts on the edge. The SIMD kernels of project() give the same bits as this function. dx, dy: unit
/// direction of the beam, along the axes of the world frame. ox, oy: origin of the beam relative to the
/// reference point, metres.
float inverse_range(const RayEdge& edge, float dx, float dy, float ox, float oy);

/// Converts an inverse range, 1/m, to a range, metres. If inverse <= 1 / range_max, or if `inverse` is NaN,
/// the result is exactly range_max. Otherwise the result is 1 / inverse, but at most range_max; 0 if
/// `inverse` is infinite. range_max: metres, above 0.
inline float range_of(float inverse, float range_max) {
  if (!(inverse > 1.0f / range_max)) return range_max;
  const float range = 1.0f / inverse;
  return range < range_max ? range : range_max;
}

}  // namespace troupe::partition
