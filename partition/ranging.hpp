#pragma once

#include "base/pose.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

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

/// A fan of beams at one height. Beam i starts at (ox, oy) and runs along the unit vector (dx, dy), both in
/// the world's orientation, relative to the reference point.
struct Fan {
  std::span<const float> dx;
  std::span<const float> dy;
  std::span<const float> ox;
  std::span<const float> oy;
  bool common_origin = false;  ///< all origins are 0
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

/// Raises inverse[i] to the inverse range at which beam i meets one of the edges, where that is larger.
/// sizes  inverse: one a beam
void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse);

/// The same, and returns[i] becomes the ranger_return of the edge that is met; of two at one range, the
/// larger.
void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse,
             std::span<float> returns);

/// False only when no beam of the fan can meet anything within the circle nearer than it has met something
/// already: a cull of whole bodies, with a margin far above rounding.
bool may_meet(const Fan& fan, float x, float y, float radius, std::span<const float> inverse);

/// The inverse range of one beam and one edge: the formula itself, 0 where they do not meet. Infinity when
/// the beam starts on the edge.
float inverse_range(const RayEdge& edge, float dx, float dy, float ox, float oy);

/// Ranges from inverse ranges: range_max exactly unless inverse > 1 / range_max.
inline float range_of(float inverse, float range_max) {
  if (!(inverse > 1.0f / range_max)) return range_max;
  const float range = 1.0f / inverse;
  return range < range_max ? range : range_max;
}

}  // namespace troupe::partition
