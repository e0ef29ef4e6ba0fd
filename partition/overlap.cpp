#include "partition/overlap.hpp"

#include "partition/placed_shape.hpp"

#include <limits>

namespace troupe::partition {

PieceCircle circle_about(const Ring& outline) {
  const Box box = bounds(outline);
  PieceCircle circle{box.center(), 0};
  for (const Vec2& v : outline) circle.radius = std::max(circle.radius, (v - circle.centre).squaredNorm());
  circle.radius = sqrt(circle.radius);
  return circle;
}

ObstacleShape make_obstacle_shape(std::span<const ConvexPrism> pieces) {
  ObstacleShape shape;
  shape.pieces.assign(pieces.begin(), pieces.end());
  if (pieces.empty()) return shape;
  shape.thinnest = std::numeric_limits<double>::infinity();
  shape.z = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  double radius2 = 0;
  for (const ConvexPrism& piece : pieces) {
    shape.circles.push_back(circle_about(piece.outline));
    shape.vertices += piece.outline.size();
    for (const Vec2& v : piece.outline) radius2 = std::max(radius2, v.squaredNorm());
    shape.thinnest = std::min(shape.thinnest, convex_width(piece.outline));
    shape.z.min = std::min(shape.z.min, piece.z.min);
    shape.z.max = std::max(shape.z.max, piece.z.max);
  }
  shape.radius = sqrt(radius2);
  return shape;
}

namespace {

/// Returns the piece with its edges moved inwards by `depth`, m.
ConvexPrism inset(const ConvexPrism& piece, double depth) {
  ConvexPrism out = piece;
  const Ring& ring = piece.outline;
  // The inward unit normal of the edge that starts at this corner; zero for an edge of length 0.
  const auto inward = [&ring](std::size_t edge) {
    const Vec2 along = ring[(edge + 1) % ring.size()] - ring[edge];
    const double length = along.norm();
    return length > 0 ? Vec2(-along.y() / length, along.x() / length) : Vec2(0, 0);
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 before = inward((i + ring.size() - 1) % ring.size());
    const Vec2 after = inward(i);
    out.outline[i] += depth / (1 + before.dot(after)) * (before + after);
  }
  return out;
}

/// True if the polygon lies to the left of the line through its edge that starts at p[j] and has the
/// direction `edge`. This holds for every edge of a convex polygon, unless the edge is so short that the
/// rounding of its ends changes its direction. The line of such an edge may cut its own polygon, and then it
/// cannot separate this polygon from another one. (The alternative, merging corners that are close together,
/// was rejected: which distance is too small depends on the distance from the origin.)
template <class Polygon>
bool bounds_its_polygon(const Polygon& p, std::size_t j, const Vec2& edge) {
  double low = 0;
  double high = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double side = cross(edge, p[k] - p[j]);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return high > 0 && low >= -1e-9 * high;
}

/// Whether the line through an edge of p separates p from q. Two convex polygons share no area if and only if
/// the line through an edge of one of them separates them. The comparison is `> 0`, because polygons that
/// only touch count as separated.
template <class P, class Q>
bool separated_by_edges_of(const P& p, const Q& q) {
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    const Vec2& start = p[j];
    const Vec2 edge = p[i] - start;
    bool separates = true;
    for (std::size_t k = 0; k < q.size(); ++k) {
      if (cross(edge, q[k] - start) > 0) {
        separates = false;
        break;
      }
    }
    if (separates && bounds_its_polygon(p, j, edge)) return true;
  }
  return false;
}

template <class Polygon>
bool enters(const Vec2& s0, const Vec2& s1, const Polygon& polygon) {
  const Vec2 along = s1 - s0;
  bool left = false;
  bool right = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const double side = cross(along, polygon[i] - s0);
    left = left || side > 0;
    right = right || side < 0;
  }
  if (!left || !right) return false;  // the segment's line does not enter the polygon
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2& start = polygon[j];
    const Vec2 edge = polygon[i] - start;
    if (cross(edge, s0 - start) <= 0 && cross(edge, s1 - start) <= 0 && bounds_its_polygon(polygon, j, edge))
      return false;
  }
  return true;
}

}  // namespace

ObstacleShape inset(const ObstacleShape& shape, double depth) {
  std::vector<ConvexPrism> pieces;
  for (const ConvexPrism& piece : shape.pieces) pieces.push_back(inset(piece, depth));
  return make_obstacle_shape(pieces);
}

bool convex_overlap(std::span<const Vec2> a, std::span<const Vec2> b) {
  return !separated_by_edges_of(a, b) && !separated_by_edges_of(b, a);
}
bool convex_overlap(std::span<const Vec2> a, const PlacedRing& b) {
  return !separated_by_edges_of(a, b) && !separated_by_edges_of(b, a);
}

bool segment_overlap(const Vec2& s0, const Vec2& s1, std::span<const Vec2> polygon) {
  return enters(s0, s1, polygon);
}
bool segment_overlap(const Vec2& s0, const Vec2& s1, const PlacedRing& polygon) {
  return enters(s0, s1, polygon);
}

PlacedShape::PlacedShape(const ObstacleShape& shape, const Transform& transform_world_body, double z)
    : shape_(shape), transform_(transform_world_body), z_(z) {
  if (shape.vertices > vertices_.size()) return;
  Vec2* out = vertices_.data();
  for (const ConvexPrism& piece : shape.pieces)
    for (const Vec2& v : piece.outline) *out++ = transform_ * v;
}

bool overlap(const PlacedShape& a, const PlacedShape& b) {
  const ObstacleShape& shape_a = a.shape();
  const ObstacleShape& shape_b = b.shape();
  if (!in_reach(a.position(), shape_a.radius, b.position(), shape_b.radius)) return false;
  if (!shape_a.z.shifted(a.z()).overlaps(shape_b.z.shifted(b.z()))) return false;
  const bool has_several = shape_a.pieces.size() + shape_b.pieces.size() > 2;
  return a.any_piece([&](const ConvexPrism& piece_a, const auto& ring_a) {
    PieceCircle circle_a{Vec2::Zero(), 0};
    if (has_several) {
      circle_a = a.circle_of(piece_a);
      if (!in_reach(circle_a.centre, circle_a.radius, b.position(), shape_b.radius)) return false;
    }
    const ZInterval z = piece_a.z.shifted(a.z());
    return b.any_piece([&](const ConvexPrism& piece_b, const auto& ring_b) {
      if (has_several) {
        const PieceCircle circle_b = b.circle_of(piece_b);
        if (!in_reach(circle_a.centre, circle_a.radius, circle_b.centre, circle_b.radius)) return false;
      }
      return z.overlaps(piece_b.z.shifted(b.z())) && !separated_by_edges_of(ring_a, ring_b) &&
             !separated_by_edges_of(ring_b, ring_a);
    });
  });
}

bool is_near_segment(const PlacedShape& shape, const Vec2& a, const Vec2& b, double distance,
                     const ZInterval& z) {
  return shape.any_piece([&](const ConvexPrism& piece, const auto& ring) {
    if (!piece.z.shifted(shape.z()).overlaps(z)) return false;
    bool is_inside = true;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2& from = ring[i];
      const Vec2& to = ring[i + 1 < ring.size() ? i + 1 : 0];
      if (segment_distance(a, b, from, to) <= distance) return true;
      is_inside = is_inside && cross(to - from, a - from) > 0;
    }
    return is_inside;
  });
}

bool pieces_in_reach(const ObstacleShape& a, const Transform& at_a, const ObstacleShape& b,
                     const Transform& at_b, double distance) {
  for (const PieceCircle& circle_a : a.circles) {
    const Vec2 centre = at_a * circle_a.centre;
    const double radius = circle_a.radius + distance;
    if (!in_reach(centre, radius, at_b.position, b.radius)) continue;
    for (const PieceCircle& circle_b : b.circles)
      if (in_reach(centre, radius, at_b * circle_b.centre, circle_b.radius)) return true;
  }
  return false;
}

bool overlap(const ObstacleShape& a, const Pose& pose_world_a, const ObstacleShape& b,
             const Pose& pose_world_b) {
  if (!in_reach(pose_world_a.position(), a.radius, pose_world_b.position(), b.radius)) return false;
  return overlap(PlacedShape(a, pose_world_a), PlacedShape(b, pose_world_b));
}

}  // namespace troupe::partition
