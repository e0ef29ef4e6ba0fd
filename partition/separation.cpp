#include "partition/separation.hpp"

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

}  // namespace troupe::partition
