#pragma once

#include "base/pose.hpp"
#include "partition/surroundings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

/// A fan of beams at one height. Beam i starts at (ox, oy) and runs along the unit vector (dx, dy), both in
/// the world's orientation, relative to the reference point. Each array has padded_beams(count) entries, of
/// which those beyond count repeat the last.
struct Fan {
  const float* dx = nullptr;
  const float* dy = nullptr;
  const float* ox = nullptr;
  const float* oy = nullptr;
  std::size_t count = 0;
  bool common_origin = false;  ///< all origins are 0
  bool mirrored = false;  ///< the second half looks in the opposite directions of the first, in their order

  std::size_t padded() const { return padded_beams(count); }
};

/// An edge relative to the reference point.
struct RayEdge {
  float ax, ay, bx, by;
  float ex, ey;  ///< b - a, rounded once
  float area;    ///< a x b, rounded once; exactly 0 where the edge's line meets the reference point
  float ranger_return;
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

/// Edges in the world's frame on their way to a fan.
class EdgeBlock {
 public:
  static constexpr std::size_t k_capacity = 128;

  void clear() { count_ = 0; }
  std::size_t count() const { return count_; }
  /// How many more it takes.
  std::size_t room() const { return k_capacity - count_; }
  void add(const Vec2& a, const Vec2& b, float ranger_return) {
    Eigen::Map<Eigen::Matrix<double, 4, 1>>(&ends_[4 * count_]) << a, b;
    returns_[count_++] = ranger_return;
  }

  /// ends: ax, ay, bx, by of so many.
  void add(const double* ends, std::size_t count, float ranger_return) {
    std::copy_n(ends, 4 * count, &ends_[4 * count_]);
    std::fill_n(&returns_[count_], count, ranger_return);
    count_ += count;
  }

  const double* ends() const { return ends_.data(); }  ///< ax, ay, bx, by of each, aligned to 64 bytes
  float ranger_return(std::size_t i) const { return returns_[i]; }
  RayEdge relative(std::size_t i, const Vec2& reference) const {
    const double* e = &ends_[4 * i];
    return relative_edge({e[0], e[1]}, {e[2], e[3]}, reference, returns_[i]);
  }

 private:
  alignas(64) std::array<double, 4 * k_capacity> ends_{};
  std::array<float, k_capacity> returns_{};
  std::size_t count_ = 0;
};

/// Beams from one origin at equal angles, counter-clockwise: a scanner's, of which there are many. Then an
/// edge is projected only on the beams that it spans.
struct Scan {
  Vec2 middle = Vec2::UnitX();  ///< direction halfway between the first and the last beam, world frame
  float fov = 0;                ///< between the first and the last beam, rad
  float step = 0;               ///< between neighbours, rad
};

/// Turns unit vectors (x, y) and rounds them once to float. All arrays have padded_beams(count) entries.
void turn(const Rotation& rotation, const double* x, const double* y, std::size_t count, float* out_x,
          float* out_y);

/// Raises inverse[i] to the inverse range at which beam i meets one of the edges, where that is larger.
/// inverse  fan.padded() entries
/// returns  as many, or null: becomes the ranger_return of the edge that is met; of two at one range, the
///          larger
void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse, float* returns);
/// The same, bit for bit, for a fan that is a scan.
void project(const EdgeBlock& edges, const Vec2& reference, const Fan& fan, const Scan& scan, float* inverse,
             float* returns);

/// How far each beam can still go, m: its range so far or range_max, with the slack that culls leave. Returns
/// the farthest.
/// inverse, range_max, limits  fan.padded() entries
float limits_of(const Fan& fan, const float* inverse, const float* range_max, float* limits);

/// The readings: range_of() of each beam. All arrays but ranges are padded.
void ranges_of(const Fan& fan, const float* inverse, const float* range_max, float* ranges);

/// Culls circles: leaves in met.row those of [begin, end) that some beam may meet before its limit and whose
/// nearest point lies from `low` to `high` away from the reference, and returns their number. Margins are far
/// above rounding: it leaves out none that counts.
/// begin, end  multiples of k_circle_padding; circles with negative infinite radius are never met
inline constexpr std::size_t k_circle_padding = 16;
std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const float* limits, float low, float high, CircleArrays& met);
/// The same for a fan that is a scan; it keeps a few more.
std::size_t may_meet(const CircleArrays& circles, std::size_t begin, std::size_t end, const Vec2& reference,
                     const Fan& fan, const Scan& scan, const float* limits, float low, float high,
                     CircleArrays& met);

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
