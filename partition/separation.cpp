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

/// Depth of two convex polygons in each other, m; 0 or less: they share no area.
template <class P, class Q>
double depth_of(const P& a, const Q& b) {
  Way way;
  shorten(a, b, 1, way);
  if (way.depth > 0) shorten(b, a, -1, way);
  return way.depth;
}

}  // namespace

std::optional<Vec2> way_out(const PlacedShape& a, const PlacedShape& b) {
  if (!in_reach(a.position(), a.shape().radius, b.position(), b.shape().radius)) return {};
  Way longest{Vec2::Zero(), 0};
  a.any_piece([&](const ConvexPrism& piece_a, const auto& ring_a) {
    const PieceCircle circle_a = a.circle_of(piece_a);
    if (!in_reach(circle_a.centre, circle_a.radius, b.position(), b.shape().radius)) return false;
    const ZInterval z = piece_a.z.shifted(a.z());
    return b.any_piece([&](const ConvexPrism& piece_b, const auto& ring_b) {
      const PieceCircle circle_b = b.circle_of(piece_b);
      if (!in_reach(circle_a.centre, circle_a.radius, circle_b.centre, circle_b.radius)) return false;
      if (!z.overlaps(piece_b.z.shifted(b.z()))) return false;
      Way way;
      shorten(ring_a, ring_b, 1, way);
      if (way.depth > 0) shorten(ring_b, ring_a, -1, way);
      if (way.depth > longest.depth) longest = way;
      return false;
    });
  });
  if (!(longest.depth > 0)) return {};
  return longest.depth * longest.out;
}

bool deepens(const PlacedShape& before, const PlacedShape& after, const PlacedShape& other) {
  constexpr double k_noise_m = 1e-12;
  if (!in_reach(after.position(), after.shape().radius, other.position(), other.shape().radius)) return false;
  return after.any_piece([&](const ConvexPrism& piece, const auto& ring) {
    const PieceCircle circle = after.circle_of(piece);
    if (!in_reach(circle.centre, circle.radius, other.position(), other.shape().radius)) return false;
    const ZInterval z = piece.z.shifted(after.z());
    const ConvexPrism& was =
        before.shape().pieces[static_cast<std::size_t>(&piece - after.shape().pieces.data())];
    return other.any_piece([&](const ConvexPrism& its, const auto& its_ring) {
      const PieceCircle its_circle = other.circle_of(its);
      const ZInterval its_z = its.z.shifted(other.z());
      if (!in_reach(circle.centre, circle.radius, its_circle.centre, its_circle.radius) || !z.overlaps(its_z))
        return false;
      const double depth = depth_of(ring, its_ring);
      if (!(depth > 0)) return false;
      if (!was.z.shifted(before.z()).overlaps(its_z)) return true;
      const double depth_before = depth_of(PlacedRing(was.outline, before.transform()), its_ring);
      return !(depth_before > 0) || depth > std::max(depth_before + k_noise_m, k_rounding_m);
    });
  });
}

}  // namespace troupe::partition
