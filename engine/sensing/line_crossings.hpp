#pragma once

#include "engine/sensing/sensing_view.hpp"
#include "partition/near_circles.hpp"

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// A straight line in space between two points, which may have different heights.
struct SpatialLine {
  Vec2 from = Vec2::Zero();  ///< first point, world frame, m
  Vec2 way = Vec2::Zero();   ///< vector from the first point to the second, world frame, m
  double z_from = 0;         ///< height of the first point, m
  double z_way = 0;          ///< height of the second point above the first, m
  double length2 = 0;        ///< squared length of `way`, m^2

  /// The line from `a` at height z_a to `b` at height z_b; world frame, m.
  SpatialLine(const Vec2& a, double z_a, const Vec2& b, double z_b)
      : from(a), way(b - a), z_from(z_a), z_way(z_b - z_a), length2(way.squaredNorm()) {}

  /// Returns false only if the line, seen from above, does not touch the circle with this centre (world
  /// frame, m) and radius (m). Returns true for all lines that touch the circle, and for some that only pass
  /// near it.
  bool passes_near(const Vec2& centre, double radius) const;
  /// A box (world frame, m) that contains the section of the line between two positions. A position is a
  /// fraction of the length of the line: 0 is the first point, 1 the second.
  Box piece(double first, double last) const;
};

/// Finds out whether straight lines that begin or end at one point, the *origin*, cross walls or mobile
/// bodies. Bodies consist of solids. A solid is a polygon that is extruded over a height interval. A *wall*
/// is a solid of a static body: a body that does not move during a run.
///
/// A line crosses a solid if two conditions hold. Seen from above, the line crosses an edge of the polygon,
/// at a point that is not an end of the line. At this point, the height of the line is within the height
/// interval of the solid. A vertical line therefore crosses nothing. A line crosses a body if it crosses any
/// solid of the body. Solids that rangers (distance sensors) do not see are ignored.
///
/// Not thread-safe. Keep one object per thread and reuse it: its arrays keep their memory.
class LineCrossings {
 public:
  /// If the argument `longest` of find_walls() or find_bodies() is at most this length, m, the function
  /// searches the neighbourhood of the origin once for all lines. Otherwise, each later query searches along
  /// its own line. This length affects only the computing time.
  static constexpr double k_together_m = 12;

  LineCrossings();  ///< an object without an origin: call stand() first
  /// Sets the origin of the lines (world frame, m), and discards the results of find_walls() and
  /// find_bodies(). Until the last query, the view must exist and the world must not change.
  void stand(const SensingView& view, const Vec2& origin);
  /// Prepares crosses_wall() and count_walls() for lines whose horizontal length is at most `longest`, m.
  /// Returns false if it is certain that none of these lines crosses a wall.
  bool find_walls(double longest);
  /// Prepares crosses_body() for lines whose horizontal length is at most `longest`, m. `candidates` must
  /// contain the enclosing circle of every mobile body that may have a point within the distance `longest` of
  /// the origin. The circles are copied.
  void find_bodies(double longest, std::span<const partition::BodyCircle> candidates);

  /// Whether the line crosses a wall. One end of the line must be the origin. Call find_walls() before.
  bool crosses_wall(const SpatialLine& line) const;
  /// Number of walls that the line crosses. One end of the line must be the origin. Call find_walls() before.
  ///
  /// A line that passes through a solid crosses two edges of the solid, which count as one wall. A line that
  /// ends inside the solid crosses one edge, which also counts as one wall. In general, n crossed edges of
  /// one solid count as n / 2 walls, rounded up.
  int count_walls(const SpatialLine& line);
  /// Whether the line crosses any mobile body. Ignores the bodies of the rows a and b, and all bodies that
  /// move together with them (SensingView::same_tree()). A row is the index of a body in the state tables;
  /// both rows must be valid. One end of the line must be the origin. Call find_bodies() before.
  bool crosses_body(const SpatialLine& line, Row a, Row b) const;

 private:
  /// A crossing of a line and an edge. The same crossing may be found several times, because the spatial
  /// index lists a long edge several times.
  struct Crossing {
    std::uint32_t solid;
    double at;    // position on the line, from 0 to 1
    double x, y;  // first end of the edge
    auto operator<=>(const Crossing&) const = default;
  };
  /// A circle that encloses a piece of a wall.
  struct NearWall {
    double near;  // distance of the circle from the origin, m; negative: the origin is inside
    double radius;
    Vec2 centre;  // world frame, m
    std::uint32_t piece;
  };
  template <class Visit>
  bool any_wall(const SpatialLine& line, Visit&& visit) const;
  bool hides(const SpatialLine& line, Row row) const;

  const SensingView* view_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  partition::NearCircles walls_;               // pieces of outlines near the origin; scratch memory
  std::vector<NearWall> near_walls_;           // the same, from near to far
  std::vector<partition::BodyCircle> bodies_;  // bodies near the origin
  bool are_walls_gathered_ = false;            // whether walls_ contains all walls that lines may cross
  bool are_bodies_gathered_ = false;           // whether bodies_ contains all bodies that lines may cross
  std::vector<Crossing> crossings_;
};

}  // namespace troupe::engine
