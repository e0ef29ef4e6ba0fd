#include "partition/separation.hpp"

#include <algorithm>
#include <limits>

namespace troupe::partition {
namespace {

struct Way {
  Vec2 out = Vec2::Zero();  // unit vector
  double depth = std::numeric_limits<double>::infinity();
};

/// Searches the outward normals of the edges of `polygon` for the shortest displacement that moves `other`
/// out of it. If this is shorter than `way`, it replaces `way`. Skips edges that are too short to have a
/// direction. sign: 1 if `other` is the shape that moves, -1 if `polygon` is.
template <class P, class Q>
void shorten(const P& polygon, const Q& other, double sign, Way& way) {
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2& start = polygon[j];
    const Vec2 edge = polygon[i] - start;
    const double length = sqrt(edge.squaredNorm());
    if (!(length > k_rounding_m)) continue;
    const Vec2 out(edge.y() / length, -edge.x() / length);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < other.size(); ++k) nearest = std::min(nearest, out.dot(other[k] - start));
    if (-nearest < way.depth) way = {sign * out, -nearest};
  }
}

/// The shortest way of `b` out of `a`. Two convex polygons share no area if Way::depth is 0 or less.
template <class P, class Q>
Way shortest_way(const P& a, const Q& b) {
  Way way;
  shorten(a, b, 1, way);
  if (way.depth > 0) shorten(b, a, -1, way);
  return way;
}

/// Calls visit(piece of a, its ring, piece of b, its ring) for the pieces of two shapes that may overlap at a
/// common height, until a call returns true. Returns whether a call returned true.
template <class Visit>
bool any_pair(const PlacedShape& a, const PlacedShape& b, Visit&& visit) {
  if (!in_reach(a.position(), a.shape().radius, b.position(), b.shape().radius)) return false;
  return a.any_piece([&](const ConvexPrism& piece_a, const auto& ring_a) {
    const PieceCircle circle_a = a.circle_of(piece_a);
    if (!in_reach(circle_a.centre, circle_a.radius, b.position(), b.shape().radius)) return false;
    const ZInterval z = piece_a.z.shifted(a.z());
    return b.any_piece([&](const ConvexPrism& piece_b, const auto& ring_b) {
      const PieceCircle circle_b = b.circle_of(piece_b);
      return in_reach(circle_a.centre, circle_a.radius, circle_b.centre, circle_b.radius) &&
             z.overlaps(piece_b.z.shifted(b.z())) && visit(piece_a, ring_a, piece_b, ring_b);
    });
  });
}

}  // namespace

std::optional<Vec2> way_out(const PlacedShape& a, const PlacedShape& b) {
  Way longest{Vec2::Zero(), 0};
  any_pair(a, b, [&](const ConvexPrism&, const auto& ring_a, const ConvexPrism&, const auto& ring_b) {
    const Way way = shortest_way(ring_a, ring_b);
    if (way.depth > longest.depth) longest = way;
    return false;
  });
  if (!(longest.depth > 0)) return {};
  return longest.depth * longest.out;
}

bool deepens(const PlacedShape& before, const PlacedShape& after, const PlacedShape& other) {
  constexpr double k_noise_m = 1e-12;
  return any_pair(
      after, other,
      [&](const ConvexPrism& piece, const auto& ring, const ConvexPrism& its, const auto& its_ring) {
        const double depth = shortest_way(ring, its_ring).depth;
        if (!(depth > 0)) return false;
        const ConvexPrism& was =
            before.shape().pieces[static_cast<std::size_t>(&piece - after.shape().pieces.data())];
        if (!was.z.shifted(before.z()).overlaps(its.z.shifted(other.z()))) return true;
        const double depth_before = shortest_way(PlacedRing(was.outline, before.transform()), its_ring).depth;
        return !(depth_before > 0) || depth > std::max(depth_before + k_noise_m, k_rounding_m);
      });
}

}  // namespace troupe::partition
