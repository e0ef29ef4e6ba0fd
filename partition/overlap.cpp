#include "partition/overlap.hpp"

#include "base/assert.hpp"
#include "partition/placed_shape.hpp"

#include <limits>

namespace troupe::partition {

ObstacleShape make_obstacle_shape(std::span<const ConvexPrism> pieces) {
  ObstacleShape shape;
  shape.pieces.assign(pieces.begin(), pieces.end());
  if (pieces.empty()) return shape;
  shape.thinnest = std::numeric_limits<double>::infinity();
  shape.z = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  double radius2 = 0;
  for (const ConvexPrism& piece : pieces) {
    for (const Vec2& v : piece.outline) radius2 = std::max(radius2, v.squaredNorm());
    shape.thinnest = std::min(shape.thinnest, convex_width(piece.outline));
    shape.z.min = std::min(shape.z.min, piece.z.min);
    shape.z.max = std::max(shape.z.max, piece.z.max);
  }
  shape.radius = sqrt(radius2);
  return shape;
}

namespace {

/// True when the polygon lies left of the line through its edge from p[j] along `edge`. Every edge of a
/// convex polygon is such a line, but for one so short that the rounding of its ends decides its direction:
/// that one might cut its own polygon, and then what lies right of it is not separated. (Merging corners that
/// lie close together lost: how close is too close depends on the distance from the origin.)
bool bounds_its_polygon(std::span<const Vec2> p, std::size_t j, const Vec2& edge) {
  double low = 0;
  double high = 0;
  for (const Vec2& v : p) {
    const double side = cross(edge, v - p[j]);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return high > 0 && low >= -1e-9 * high;
}

}  // namespace

bool convex_overlap(std::span<const Vec2> a, std::span<const Vec2> b) {
  // Separating axes: two convex polygons share no area exactly when the normal of one of their edges
  // separates them. `> 0`: polygons that only touch are separated.
  const auto separated_by_edges_of = [](std::span<const Vec2> p, std::span<const Vec2> q) {
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
      const Vec2 edge = p[i] - p[j];
      bool separates = true;
      for (const Vec2& v : q) {
        if (cross(edge, v - p[j]) > 0) {
          separates = false;
          break;
        }
      }
      if (separates && bounds_its_polygon(p, j, edge)) return true;
    }
    return false;
  };
  return !separated_by_edges_of(a, b) && !separated_by_edges_of(b, a);
}

bool segment_overlap(const Vec2& s0, const Vec2& s1, std::span<const Vec2> polygon) {
  const Vec2 along = s1 - s0;
  bool left = false;
  bool right = false;
  for (const Vec2& v : polygon) {
    const double side = cross(along, v - s0);
    left = left || side > 0;
    right = right || side < 0;
  }
  if (!left || !right) return false;  // the segment's line does not enter the polygon
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 edge = polygon[i] - polygon[j];
    if (cross(edge, s0 - polygon[j]) <= 0 && cross(edge, s1 - polygon[j]) <= 0 &&
        bounds_its_polygon(polygon, j, edge))
      return false;
  }
  return true;
}

PlacedShape::PlacedShape(const ObstacleShape& shape, const Pose& pose_world_body) {
  const Transform transform(pose_world_body);
  std::size_t total = 0;
  for (const ConvexPrism& piece : shape.pieces) total += piece.outline.size();
  if (total > small_.size()) large_.resize(total);
  Vec2* out = total > small_.size() ? large_.data() : small_.data();
  begin_ = out;
  for (const ConvexPrism& piece : shape.pieces)
    for (const Vec2& v : piece.outline) *out++ = transform * v;
}

bool overlap(const ObstacleShape& a, const Pose& pose_world_a, const ObstacleShape& b,
             const Pose& pose_world_b) {
  const Vec2 apart = pose_world_b.position() - pose_world_a.position();
  const double reach = a.radius + b.radius + k_rounding_m;  // a cull: never refuses what the axes would find
  if (apart.squaredNorm() > reach * reach) return false;
  if (!a.z.shifted(pose_world_a.z).overlaps(b.z.shifted(pose_world_b.z))) return false;
  const PlacedShape placed_a(a, pose_world_a);
  const PlacedShape placed_b(b, pose_world_b);
  const Vec2* va = placed_a.vertices();
  for (const ConvexPrism& pa : a.pieces) {
    const Vec2* vb = placed_b.vertices();
    for (const ConvexPrism& pb : b.pieces) {
      if (pa.z.shifted(pose_world_a.z).overlaps(pb.z.shifted(pose_world_b.z)) &&
          convex_overlap({va, pa.outline.size()}, {vb, pb.outline.size()}))
        return true;
      vb += pb.outline.size();
    }
    va += pa.outline.size();
  }
  return false;
}

}  // namespace troupe::partition
