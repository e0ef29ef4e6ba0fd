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
/// outlines. A fan is a set of beams at one height that are computed together; an edge is projected on all
/// beams of a fan at once. docs/sensing.md derives the formulas and their error bounds.
///
/// Positions relative to the reference point of the fan, a point near the origins of its beams, are computed
/// in double and rounded once to float, so that two edges with a common vertex use the same value. For a beam
/// with direction d and origin o, and a vertex v, the sign of c = (v - o) x d tells on which side of the beam
/// v is; x denotes the cross product in the plane. The beam hits edge (a, b) if c_a and c_b are on different
/// sides. Zero counts as both sides, so that no beam passes between two edges at their vertex. The inverse
/// range, 1 over the distance along the beam, is (d x e) / A, with the edge vector e = b - a and A = (a - o)
/// x (b - o); it is negative if the edge is behind the origin.
///
/// e and a x b are computed in double and then rounded to float. In exact arithmetic, d x e equals c_a - c_b,
/// and a x b could be computed from the rounded ends a and b. In floats, both expressions would lose all
/// digits for an edge that is short compared to its distance (0.3 mm of error for an edge of 5 mm at 5 m).
///
/// For three sorts of edges this formula would divide rounding errors by rounding errors: edges hit at a
/// grazing angle (|d x e| < 2^-8 (|ex| + |ey|)), edges that look tiny from the origin, and edges that pass
/// very near the origin. Edges of the last two sorts have |A| <= 2^-20 m^2, where m is the sum of the
/// magnitudes of the coordinates of a, b and o. For all three sorts, the sides of the vertices are decided as
/// above, so that no beam passes between edges, but the range is computed in double and clamped to the
/// distances that the edge can have. A beam that starts on an edge hits the edge, whatever the direction of
/// the beam.
///
/// units  metres; inverse ranges in 1/m

/// Arrays of beams are padded to a multiple of this number, which is the largest number of beams that a
/// kernel processes at a time.
inline constexpr std::size_t k_beam_padding = 16;
/// The size of an array for `count` beams, padding included.
constexpr std::size_t padded_beams(std::size_t count) {
  return (count + k_beam_padding - 1) / k_beam_padding * k_beam_padding;
}

/// The geometry of a scan: a fan of beams with one origin and equal angular steps, counter-clockwise, such as
/// that of a laser scanner. A scan may have more than k_most_beams beams.
struct Scan {
  Vec2 middle = Vec2::UnitX();  ///< unit vector halfway between first and last beam, world frame
  float fov = 0;                ///< angle between the first and the last beam, rad
  float step = 0;               ///< angle between neighbouring beams, rad
};

/// The largest number of beams of a fan (beams that are computed together) that is not a scan.
inline constexpr std::size_t k_most_beams = 32;

/// A fan of beams at one height. Beam i starts at (ox[i], oy[i]), relative to a reference point that is
/// passed along with the fan, and has the unit direction (dx[i], dy[i]). The axes of these vectors are those
/// of the world frame. Each array has padded_beams(count) entries; those beyond count repeat the last beam.
struct Fan {
  const float* dx = nullptr;   ///< x of the directions
  const float* dy = nullptr;   ///< y of the directions
  const float* ox = nullptr;   ///< x of the origins, m
  const float* oy = nullptr;   ///< y of the origins, m
  std::size_t count = 0;       ///< number of beams
  bool common_origin = false;  ///< true: all beams start at the reference point
  bool mirrored = false;       ///< true: for i < count / 2, beam i + count / 2 is opposite to beam i
  const Scan* scan = nullptr;  ///< not null if the beams form a scan

  std::size_t padded() const { return padded_beams(count); }  ///< size of each array
};

/// An edge relative to the reference point, metres.
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

/// A margin, as a fraction of a distance. Tests that discard distant edges treat each beam as longer by this
/// margin, because rounding may make the computed range to an edge smaller than r, the distance from the
/// beam's origin to the nearest point of the edge. Let s be the distance between the beam's origin and the
/// reference point of the fan. At the smallest angle that is not grazing (k_grazing), the range is too small
/// by at most 2^-14 (r + s). If s <= r, the margin is at least twice this error.
constexpr double k_range_slack = 1.0 / 4096;

/// A second margin, metres, which the tests that use k_range_slack add to the first margin. It covers the
/// rounding to float of distances near 0.
constexpr float k_cull_slack = 1e-6f;

/// An edge is hit at a grazing angle if |d x e| is less than this number times |ex| + |ey|, with d and e as
/// in the comment at the top of this file.
constexpr float k_grazing = 1.0f / 256;
/// An edge looks tiny if |A| is at most this number times m^2, with A and m as in the comment at the top of
/// this file. The sign of A, which tells on which side of the edge's line the origin is, could then be wrong
/// because of rounding.
constexpr float k_tiny = 1.0f / (1 << 20);

/// Converts the edge from a to b (world frame, metres) to coordinates relative to the reference point.
/// RayEdge::area is set to exactly 0 if its magnitude is below the rounding error of the two products of
/// which it is the difference.
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

/// A set of beams of a fan: bit i is set if beam i is in the set. For a scan, functions ignore the set and
/// find the beams by their angles.
using BeamSet = std::uint32_t;
/// The set of all beams of a fan, which must have 1 to k_most_beams beams unless it is a scan. For a scan,
/// all bits are set.
inline BeamSet all_beams(const Fan& fan) {
  return fan.scan != nullptr ? ~0u : ~0u >> (k_most_beams - fan.count);
}

/// A buffer of outlines to project on a fan, world frame, metres. The buffer stores chains of vertices, so
/// that the work per vertex is done once for both edges at the vertex. Vertices are numbered consecutively
/// over all chains. Edge j runs from vertex j to vertex j + 1; the last vertex of a chain begins no edge.
class EdgeBlock {
 public:
  static constexpr std::size_t k_capacity = 128;  ///< largest number of vertices
  static constexpr std::size_t k_piece = 8;  ///< most edges of a piece: kernels process this many at a time
  /// Consecutive edges of a chain that have the same enclosing circle.
  struct Piece {
    std::uint32_t first;  ///< number of the vertex at which its first edge begins
    std::uint32_t edges;  ///< number of edges, at most k_piece
    BeamSet met_by;       ///< the beams that may hit one of its edges
    float ranger_return;  ///< intensity that beams read from its edges
  };

  /// Removes all vertices.
  void clear() { vertices_ = pieces_count_ = 0; }
  bool empty() const { return vertices_ == 0; }       ///< whether there are no vertices
  std::size_t vertices() const { return vertices_; }  ///< number of vertices of all chains
  /// The largest number of edges that the next chain may have; 0 if the buffer is full.
  std::size_t room() const { return std::max(vertices_, k_capacity - 1) - vertices_; }

  /// Adds a chain of `edges` edges that have the same enclosing circle: from `first` to rest[0], from there
  /// to rest[1], and so on. The chain is divided into pieces of at most k_piece edges. `edges` must be from 1
  /// to room().
  /// rest: copied in groups of k_piece vertices; k_piece - 1 vertices beyond the chain must therefore be
  ///       readable
  /// met_by: the beams that may hit one of the edges
  void add(const Vec2& first, const Vec2* rest, std::size_t edges, float ranger_return, BeamSet met_by) {
    double* out = &xy_[2 * vertices_];
    out[0] = first.x();
    out[1] = first.y();
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
  /// Edge j relative to the reference point (world frame, metres). The edge must belong to a piece;
  /// ranger_return is that of the piece.
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

/// Rotates the vectors (x[i], y[i]), which are directions or origins of beams, and writes the results, each
/// rounded once to float, to out_x and out_y. All arrays have padded_beams(count) entries.
void turn(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
          float* out_y);

/// Projects the edges on all beams of a fan: raises inverse[i] to the largest inverse range (1/m) at which
/// beam i hits one of the edges, if that is larger than inverse[i]. reference: the point, m, world frame, to
/// which the origins of the beams are relative.
/// inverse  array of fan.padded() entries
/// returns  null if it is not needed, else an array of fan.padded() entries: whenever inverse[i] is raised,
///          returns[i] is set to the ranger_return of the edge. Of two edges at the same range, the larger
///          ranger_return is used
void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse, float* returns);

/// Writes to limits[i] the distance up to which beam i can still hit an edge, metres: the smaller of its
/// range so far (1 / inverse[i]) and range_max[i], plus the margins k_range_slack and k_cull_slack. Returns
/// the largest of these distances. All three arrays have fan.padded() entries.
float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits);

/// Computes the readings in metres: ranges[i] is set to range_of(inverse[i], range_max[i]). `ranges` has
/// fan.count entries; the other two arrays have fan.padded() entries.
void ranges_of(const Fan& fan, const float* inverse, const float* range_max, float* ranges);

/// The circles that may_meet() keeps: CircleArrays::row of each, and the beams that may hit it. The other
/// arrays of CircleArrays are working memory of may_meet().
struct MetCircles : CircleArrays {
  std::vector<BeamSet> beams;  ///< per circle: the beams that may hit it

  /// Ensures room for this many circles; keeps the contents.
  void make_room(std::size_t size) {
    CircleArrays::make_room(size);
    beams.resize(row.size());
  }
};

/// may_meet() requires CircleArrays that are padded to a multiple of this many circles.
inline constexpr std::size_t k_circle_padding = 16;
/// Discards circles that no beam can hit. Keeps those of the circles in [begin, end) that some beam may hit
/// before its limit and whose nearest point is from `low` to `high` away from `reference`, metres. Writes the
/// rows of the kept circles, and the beams that may hit them, to the first entries of `met`, and returns the
/// number of kept circles. The margins of these tests are far above rounding errors, so that no circle that a
/// beam hits is discarded.
/// begin, end  multiples of k_circle_padding; circles with a radius of minus infinity are never hit
/// limits      as limits_of() computes them
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
