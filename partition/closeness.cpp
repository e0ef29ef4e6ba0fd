#include "partition/closeness.hpp"

#include <algorithm>

namespace troupe::partition {
namespace {

/// As squared_distance_to_segment(), but rounds in another way. The latter is not used here, because a result
/// of come_within() at exactly the tested distance would change.
double squared_distance(const Vec2& point, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - (a + t * along)).squaredNorm();
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double ac = cross(b - a, c - a), ad = cross(b - a, d - a);
  const double ca = cross(d - c, a - c), cb = cross(d - c, b - c);
  return ((ac > 0) != (ad > 0)) && ((ca > 0) != (cb > 0));
}

/// True if the point is inside the polygon. (The alternative, testing whether the point is to the left of
/// every edge, was rejected: rounding may change the direction of a very short edge.)
template <class P>
bool holds(const P& polygon, const Vec2& point) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
    inside ^= crosses_ray(polygon[j], polygon[i], point);
  return inside;
}

template <class P, class Q>
bool rings_come_within(const P& p, const Q& q, double distance2) {
  if (holds(p, q[0]) || holds(q, p[0])) return true;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    const Vec2& a = p[j];
    const Vec2& b = p[i];
    for (std::size_t k = 0, l = q.size() - 1; k < q.size(); l = k++) {
      const Vec2& c = q[l];
      const Vec2& d = q[k];
      if (squared_distance(a, c, d) <= distance2 || squared_distance(c, a, b) <= distance2 ||
          cross_each_other(a, b, c, d))
        return true;
    }
  }
  return false;
}

}  // namespace

bool come_within(const PlacedShape& a, const PlacedShape& b, double distance) {
  const double reach_b = b.shape().radius + distance;
  if (!in_reach(a.position(), a.shape().radius, b.position(), reach_b)) return false;
  return a.any_piece([&](const ConvexPrism& piece_a, const auto& ring_a) {
    const PieceCircle circle_a = a.circle_of(piece_a);
    if (!in_reach(circle_a.centre, circle_a.radius, b.position(), reach_b)) return false;
    return b.any_piece([&](const ConvexPrism& piece_b, const auto& ring_b) {
      const PieceCircle circle_b = b.circle_of(piece_b);
      return in_reach(circle_a.centre, circle_a.radius + distance, circle_b.centre, circle_b.radius) &&
             rings_come_within(ring_a, ring_b, distance * distance);
    });
  });
}

}  // namespace troupe::partition
