#pragma once

#include "base/pose.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// The exact ray engine's arithmetic: edges are projected on all beams of a fan at once.
///
/// Positions are taken relative to the fan's reference point in double and rounded once to float, so two edges
/// that share a vertex share its value. For a beam of direction d whose origin lies at o, and a vertex v, let
/// c = (v - o) x d. The beam meets edge (a, b) where c_a and c_b lie on different sides, zero counting for both,
/// so that no beam slips between two edges at their vertex; its inverse range is (c_a - c_b) * (1 / (a x b)).
///
/// Edges seen nearly end-on, and edges that pass nearly through the origin, would divide noise by noise. For
/// them (|a x b| <= 2^-10 (|ax by| + |ay bx|), per beam) sides are decided as above, so that nothing leaks, and
/// the range is worked out in double, clamped to where the edge can be.
///
/// units  metres; inverse ranges 1/m

/// A fan of beams at one height. Beam i starts at (ox, oy) and runs along the unit vector (dx, dy), both in the
/// world's orientation, relative to the reference point.
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
  float ranger_return;
};

/// v - reference, rounded once.
inline void relative(const Vec2& v, const Vec2& reference, float& x, float& y) {
  x = static_cast<float>(v.x() - reference.x());
  y = static_cast<float>(v.y() - reference.y());
}

/// Raises inverse[i] to the inverse range at which beam i meets one of the edges, where that is larger.
/// sizes  inverse: one a beam
void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse);

/// The same, and returns[i] becomes the ranger_return of the edge that is met; of two at one range, the larger.
void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse, std::span<float> returns);

/// False only when no beam of the fan can meet anything within the circle nearer than it has met something
/// already: a cull of whole bodies, with a margin far above rounding.
bool may_meet(const Fan& fan, float x, float y, float radius, std::span<const float> inverse);

/// The inverse range of one beam and one edge: the formula itself, 0 where they do not meet. Infinity when the
/// beam starts on the edge.
float inverse_range(const RayEdge& edge, float dx, float dy, float ox, float oy);

/// Ranges from inverse ranges: range_max exactly unless inverse > 1 / range_max.
inline float range_of(float inverse, float range_max) {
  if (!(inverse > 1.0f / range_max)) return range_max;
  const float range = 1.0f / inverse;
  return range < range_max ? range : range_max;
}

}  // namespace troupe::partition
