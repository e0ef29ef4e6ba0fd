#pragma once

#include "base/pose.hpp"
#include "partition/surroundings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>

namespace troupe::partition {

/// The exact ray engine's arithmetic: edges are projected on all beams of a fan at once. docs/sensing.md
/// derives it and its bounds.
///
/// Positions are taken relative to the fan's reference point in double and rounded once to float, so two
/// edges that share a vertex share its value. For a beam of direction d whose origin lies at o, and a vertex
/// v, let c = (v - o) x d: its sign is the side of the beam that v lies on. The beam meets edge (a, b) where
/// c_a and c_b lie on different sides, zero counting for both, so that no beam slips between two edges at
/// their vertex. The inverse range is (d x e) / A, with the edge vector e = b - a and A = (a - o) x (b - o);
/// where it is negative, the edge lies behind.
///
/// e and a x b are worked out in double before they are rounded: c_a - c_b and the product of the rounded
/// ends give the same numbers in principle, but lose all digits of an edge that is short for its distance
/// (0.3 mm of error for 5 mm of edge at 5 m).
///
/// Edges met at a grazing angle (|d x e| < 2^-8 (|ex| + |ey|)), edges that look tiny, and edges that pass
/// very near the origin (|A| <= 2^-20 m^2, m the sum of all coordinates' magnitudes) would divide noise by
/// noise. For them sides are decided as above, so that nothing leaks, and the range is worked out in double
/// and clamped to where the edge can be. A beam that starts on an edge meets it, whichever way it looks.
///
/// units  metres; inverse ranges 1/m

/// Beams are taken this many at a time, or fewer: arrays of beams have room for more than there are.
inline constexpr std::size_t k_beam_padding = 16;
/// The room that an array of so many beams needs.
constexpr std::size_t padded_beams(std::size_t count) {
  return (count + k_beam_padding - 1) / k_beam_padding * k_beam_padding;
}

/// Beams from one origin at equal angles, counter-clockwise: a scanner's, of which there are many.
struct Scan {
  Vec2 middle = Vec2::UnitX();  ///< direction halfway between the first and the last beam, world frame
  float fov = 0;                ///< between the first and the last beam, rad
  float step = 0;               ///< between neighbours, rad
};

/// Most beams of a fan that is no scan.
inline constexpr std::size_t k_most_beams = 32;

/// A fan of beams at one height. Beam i starts at (ox, oy) and
/// runs along the unit vector (dx, dy), both in the world's orientation, relative to the reference point.
/// Each array has padded_beams(count) entries, of which those beyond count repeat the last.
struct Fan {
  const float* dx = nullptr;   ///< direction
  const float* dy = nullptr;   ///< direction
  const float* ox = nullptr;   ///< origin, m
  const float* oy = nullptr;   ///< origin, m
  std::size_t count = 0;       ///< beams
  bool common_origin = false;  ///< all origins are 0
  bool mirrored = false;  ///< the second half looks in the opposite directions of the first, in their order
  const Scan* scan = nullptr;  ///< what is known of the beams where they are a scan

  std::size_t padded() const { return padded_beams(count); }  ///< room that each array has
};

/// An edge relative to the reference point.
struct RayEdge {
  float ax;             ///< from
  float ay;             ///< from
  float bx;             ///< to
  float by;             ///< to
  float ex;             ///< b - a, rounded once
  float ey;             ///< b - a, rounded once
  float area;           ///< a x b, rounded once; exactly 0 where the edge's line meets the reference point
  float ranger_return;  ///< intensity that a beam reads
};

/// The share of its distance by which an edge may be met short of its nearest point: at most 2^-14 by
/// rounding at the least angle that counts as no grazing, and 2^-14 of an origin's offset. Culls by distance
/// leave twice that.
constexpr double k_range_slack = 1.0 / 4096;

/// What culls leave beside, m: float noise close to an origin.
constexpr float k_cull_slack = 1e-6f;

/// Below this sine of the angle to the beam, over the edge's |ex| + |ey|, an edge is met at a grazing angle.
constexpr float k_grazing = 1.0f / 256;
/// Below this area over m^2, noise could decide on which side of an edge's line the origin lies.
constexpr float k_tiny = 1.0f / (1 << 20);

/// An edge, given in the world's frame.
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

/// Some beams of a fan, a bit for each. Of a scan it says nothing: its beams are found by their angles.
using BeamSet = std::uint32_t;
/// Every beam of the fan; of a scan all bits.
inline BeamSet all_beams(const Fan& fan) {
  return fan.scan != nullptr ? ~0u : ~0u >> (k_most_beams - fan.count);
}

/// Outlines in the world's frame on their way to a fan: chains of vertices, so that edges share what is
/// worked out of a vertex. Edge j runs from vertex j to vertex j + 1, if it belongs to a piece; between two
/// chains there is no edge.
class EdgeBlock {
 public:
  static constexpr std::size_t k_capacity = 128;  ///< vertices
  static constexpr std::size_t k_piece = 8;  ///< most edges of a piece: as many as kernels take at a time
  /// Consecutive edges of a chain that one circle encloses.
  struct Piece {
    std::uint32_t first;  ///< vertex with which its first edge begins
    std::uint32_t edges;  ///< their number, at most k_piece
    BeamSet met_by;       ///< the beams that may meet one of its edges
    float ranger_return;  ///< of its edges
  };

  /// Removes all vertices.
  void clear() { vertices_ = pieces_count_ = 0; }
  bool empty() const { return vertices_ == 0; }       ///< whether there are none
  std::size_t vertices() const { return vertices_; }  ///< of all chains together
  /// How many edges a chain may have.
  std::size_t room() const { return std::max(vertices_, k_capacity - 1) - vertices_; }

  /// A chain of so many edges that one circle encloses: from `first` to rest[0], to rest[1] and so on.
  /// rest  is copied by whole pieces: k_piece - 1 more vertices can be read behind it
  void add(const Vec2& first, const Vec2* rest, std::size_t edges, float ranger_return, BeamSet met_by) {
    double* out = &xy_[2 * vertices_];
    out[0] = first.x();
    out[1] = first.y();
    std::size_t done = 0;
    do {
      // The number of edges is unpredictable, so a whole piece is copied: the next one overwrites the excess.
      const std::size_t left = edges - done;
      std::memcpy(out + 2 + 2 * done, rest[done].data(), 2 * k_piece * sizeof(double));
      pieces_[pieces_count_++] = {static_cast<std::uint32_t>(vertices_ + done),
                                  static_cast<std::uint32_t>(std::min(left, k_piece)), met_by, ranger_return};
      done += k_piece;
    } while (done < edges);
    vertices_ += edges + 1;
  }

  // Kernels read whole vectors, beyond the last vertex too.
  const double* xy() const { return xy_.data(); }  ///< x and y of each vertex, aligned to 64 bytes
  /// In the order in which they were added.
  std::span<const Piece> pieces() const { return {pieces_.data(), pieces_count_}; }
  /// Edge j as kernels see it; must belong to a piece, which has this ranger_return.
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

/// Turns unit vectors (x, y) and rounds them once to float. All arrays have padded_beams(count) entries.
void turn(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
          float* out_y);

/// Raises inverse[i] to the inverse range at which beam i meets one of the edges, where that is larger.
/// inverse  fan.padded() entries
/// returns  as many, or null: becomes the ranger_return of the edge that is met; of two at one range, the
///          larger
void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse, float* returns);

/// How far each beam can still go, m: its range so far or range_max, with the slack that culls leave. Returns
/// the farthest.
/// inverse, range_max, limits  fan.padded() entries
float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits);

/// The readings: range_of() of each beam. All arrays but ranges are padded.
void ranges_of(const Fan& fan, const float* inverse, const float* range_max, float* ranges);

/// What beams may meet: circles that were not culled.
struct MetCircles : CircleArrays {
  std::vector<BeamSet> beams;  ///< of each circle: those that may meet it

  /// Makes room for so many circles.
  void make_room(std::size_t size) {
    CircleArrays::make_room(size);
    beams.resize(row.size());
  }
};

/// What CircleArrays are padded to for may_meet(), in circles.
inline constexpr std::size_t k_circle_padding = 16;
/// Culls circles: leaves in `met` the rows and the beams of those of [begin, end) that some beam may meet
/// before its limit and whose nearest point lies from `low` to `high` away from the reference, and returns
/// their number. Margins are far above rounding: it leaves out none that counts.
/// begin, end  multiples of k_circle_padding; circles with negative infinite radius are never met
std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const float* limits, float low, float high, MetCircles& met);

/// The inverse range of one beam and one edge: the formula itself, 0 where they do not meet. Infinity when
/// the beam starts on the edge.
float inverse_range(const RayEdge& edge, float dx, float dy, float ox, float oy);

/// The range of an inverse range: range_max exactly unless inverse > 1 / range_max.
inline float range_of(float inverse, float range_max) {
  if (!(inverse > 1.0f / range_max)) return range_max;
  const float range = 1.0f / inverse;
  return range < range_max ? range : range_max;
}

}  // namespace troupe::partition
