#pragma once

#include "engine/sensing/sensing_view.hpp"
#include "partition/near_circles.hpp"

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// A straight line in space between two points. Unlike the rays of engine/sensing/sight.hpp, it may rise or
/// fall.
struct SpatialLine {
  Vec2 from = Vec2::Zero();  ///< first point, world frame, m
  Vec2 way = Vec2::Zero();   ///< vector from the first point to the second, world frame, m
  double z_from = 0;         ///< height of the first point, m
  double z_way = 0;          ///< height of the second point above the first, m
  double length2 = 0;        ///< squared length of `way`, m^2

  /// The line from `a` at height z_a to `b` at height z_b; world frame, m.
  SpatialLine(const Vec2& a, double z_a, const Vec2& b, double z_b)
      : from(a), way(b - a), z_from(z_a), z_way(z_b - z_a), length2(way.squaredNorm()) {}

  /// Whether the line may touch the circle with this centre (world frame, m) and radius (m).
  bool passes_near(const Vec2& centre, double radius) const;
  /// A box (world frame, m) that contains the section of the line between the positions `first` and `last`. A
  /// position is a fraction of the length of the line, from 0 to 1.
  Box piece(double first, double last) const;
};

/// Finds what straight lines from one point, the origin, cross: walls and bodies that can move. Walls are the
/// outlines of static bodies, which do not move during a run. A line crosses an outline if it crosses an edge
/// of the outline between the two ends of the line, at a height within the height interval of the outline. A
/// vertical line crosses nothing. Outlines that rangers (distance sensors) do not see are ignored. Not
/// thread-safe. Keep one object per thread and reuse it: its arrays keep their memory.
class LineCrossings {
 public:
  /// A horizontal length, m, which affects only the computing time. If `longest` in find_walls() or
  /// find_bodies() is at most this length, one search around the origin serves all lines. Otherwise the
  /// surroundings of each line are searched separately, piece by piece.
  static constexpr double k_together_m = 12;

  LineCrossings();  ///< an object without an origin: call stand() first
  /// Sets the origin of the lines (world frame, m), and discards the results of find_walls() and
  /// find_bodies(). Until the last query, the view must exist and the world must not change.
  void stand(const SensingView& view, const Vec2& origin);
  /// Prepares the queries for walls, for lines whose horizontal length is at most `longest`, m. Returns
  /// false if it is certain that no such line crosses a wall.
  bool find_walls(double longest);
  /// Prepares the queries for bodies, for lines whose horizontal length is at most `longest`, m. `candidates`
  /// must contain the enclosing circle of every body that may have a point within this distance of the
  /// origin. The circles are copied.
  void find_bodies(double longest, std::span<const partition::BodyCircle> candidates);

  /// Whether the line crosses a wall. Call find_walls() before. One end of the line must be the origin.
  bool crosses_wall(const SpatialLine& line) const;
  /// Number of walls that the line crosses. A static body consists of solids (extruded polygons). A line that
  /// enters and leaves a solid has two crossings with its outline, which count as one wall. An end of the
  /// line inside the solid leaves a single crossing. So 2 n or 2 n - 1 crossings of one solid are n walls.
  /// Call find_walls() before. One end of the line must be the origin.
  int count_walls(const SpatialLine& line);
  /// Whether the line crosses any body except the bodies of the rows (indices in the state tables) a and b,
  /// and except bodies that move together with one of these two (SensingView::same_tree()). Both rows must be
  /// valid. Call find_bodies() before. One end of the line must be the origin.
  bool crosses_body(const SpatialLine& line, Row a, Row b) const;

 private:
  /// A crossing of a line and an edge. A long edge has several circles in the index, so its crossing may be
  /// found several times.
  struct Crossing {
    std::uint32_t solid;
    double at;    // position on the line, from 0 to 1
    double x, y;  // first end of the edge
    auto operator<=>(const Crossing&) const = default;
  };
  template <class Visit>
  bool any_wall(const SpatialLine& line, Visit&& visit) const;
  bool hides(const SpatialLine& line, Row row) const;

  const SensingView* view_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  partition::NearCircles walls_;               // pieces of outlines near the origin
  std::vector<partition::BodyCircle> bodies_;  // bodies near the origin
  bool are_walls_gathered_ = false;            // whether walls_ contains all walls that lines may cross
  bool are_bodies_gathered_ = false;           // whether bodies_ contains all bodies that lines may cross
  std::vector<Crossing> crossings_;
};

}  // namespace troupe::engine
