#include "engine/sensing/line_crossings.hpp"

#include "base/math.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::engine {
namespace {

using partition::BodyCircle;

// Margin, m, of tests that discard bodies and walls too far from a line to cross it. It is far above the
// rounding errors of doubles within a world.
constexpr double k_crossing_slack_m = 1e-9;
constexpr double k_stride_m = 4;  // length of the pieces in which a long line is searched

/// Divides the line into pieces and calls search(box) with a box around each piece, until a call returns
/// true. Returns whether a call returned true.
template <class Search>
bool any_piece(const SpatialLine& line, Search&& search) {
  const auto strides = std::max(1.0, std::ceil(sqrt(line.length2) / k_stride_m));
  for (double i = 0; i < strides; ++i)
    if (search(line.piece(i / strides, (i + 1) / strides))) return true;
  return false;
}

/// Calls visit(position on the line from 0 to 1, first end of the edge) for each edge of the chain that the
/// line crosses at a height within z. Stops when a call returns true, and returns whether a call did so. A
/// vertex on the line counts as being on the left side. Therefore, if the outline crosses the line at a
/// vertex, exactly one of the two edges counts as crossed.
template <class Visit>
bool any_crossing(const SpatialLine& line, std::span<const Vec2> chain, bool closed, const ZInterval& z,
                  Visit&& visit) {
  const std::size_t edges = closed ? chain.size() : chain.size() - 1;
  for (std::size_t i = 0; i < edges; ++i) {
    const Vec2 a = chain[i] - line.from;
    const Vec2 b = chain[i + 1 < chain.size() ? i + 1 : 0] - line.from;
    const double side_a = cross(a, line.way);
    const double side_b = cross(b, line.way);
    if ((side_a > 0) == (side_b > 0)) continue;
    const double along_a = a.dot(line.way);
    const double along = along_a + side_a / (side_a - side_b) * (b.dot(line.way) - along_a);
    if (!(along > 0 && along < line.length2)) continue;
    const double share = along / line.length2;
    if (z.contains(line.z_from + share * line.z_way) && visit(share, chain[i])) return true;
  }
  return false;
}

}  // namespace

bool SpatialLine::passes_near(const Vec2& centre, double radius) const {
  const Vec2 to = centre - from;
  const double wide = radius + k_crossing_slack_m;
  const double along = to.dot(way);
  const double reach2 = wide * wide * length2;
  const double across = cross(to, way);
  if (across * across > reach2) return false;
  const double beyond = std::max(-along, along - length2);
  return beyond <= 0 || beyond * beyond <= reach2;
}

Box SpatialLine::piece(double first, double last) const {
  Box box;
  box.extend(Vec2(from + first * way));
  box.extend(Vec2(from + last * way));
  return box.expanded(k_crossing_slack_m);
}

LineCrossings::LineCrossings() {
  walls_.change_capacity(1024);
  near_walls_.reserve(1024);
  crossings_.reserve(64);
}

void LineCrossings::stand(const SensingView& view, const Vec2& origin) {
  view_ = &view;
  origin_ = origin;
  are_walls_gathered_ = are_bodies_gathered_ = false;
  bodies_.reserve(std::min<std::size_t>(view.rows(), 1024));
}

bool LineCrossings::find_walls(double longest) {
  are_walls_gathered_ = longest <= k_together_m;
  if (!are_walls_gathered_) return true;
  walls_.begin(origin_, longest);
  walls_.add_pieces(view_->scene().outlines(), longest, 0);
  const partition::CircleArrays& circles = walls_.circles();
  near_walls_.clear();
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const Vec2 way(circles.x[i], circles.y[i]);
    const double radius = circles.radius[i];
    near_walls_.push_back({sqrt(way.squaredNorm()) - radius, radius, origin_ + way, circles.row[i]});
  }
  std::ranges::sort(near_walls_, {}, &NearWall::near);
  return !near_walls_.empty();
}

void LineCrossings::find_bodies(double longest, std::span<const BodyCircle> candidates) {
  are_bodies_gathered_ = longest <= k_together_m;
  bodies_.clear();
  if (!are_bodies_gathered_) return;
  for (const BodyCircle& circle : candidates) {
    const double reach = longest + circle.radius;
    if ((Vec2(circle.x, circle.y) - origin_).squaredNorm() <= reach * reach) bodies_.push_back(circle);
  }
}

/// Calls visit(piece) at least once for each piece of an outline of the static scene that the line may cross.
/// Stops when a call returns true, and returns whether a call did so.
template <class Visit>
bool LineCrossings::any_wall(const SpatialLine& line, Visit&& visit) const {
  if (are_walls_gathered_) {
    const double length = sqrt(line.length2) + k_crossing_slack_m;
    for (const NearWall& wall : near_walls_) {
      if (wall.near > length) break;
      if (line.passes_near(wall.centre, wall.radius) && visit(wall.piece)) return true;
    }
    return false;
  }
  return any_piece(line, [&](const Box& box) {
    bool stop = false;
    view_->scene().outlines().for_each_run(box, [&](std::span<const BodyCircle> circles) {
      for (const BodyCircle& circle : circles)
        stop = stop || (line.passes_near(Vec2(circle.x, circle.y), circle.radius) && visit(circle.row));
    });
    return stop;
  });
}

bool LineCrossings::crosses_wall(const SpatialLine& line) const {
  const partition::StaticScene& scene = view_->scene();
  return any_wall(line, [&](std::uint32_t piece) {
    return any_crossing(line, scene.outlines().chain(piece), false,
                        scene.solids()[scene.outlines().solid(piece)].solid.z,
                        [](double, const Vec2&) { return true; });
  });
}

int LineCrossings::count_walls(const SpatialLine& line) {
  const partition::StaticScene& scene = view_->scene();
  crossings_.clear();
  any_wall(line, [&](std::uint32_t piece) {
    const std::uint32_t solid = scene.outlines().solid(piece);
    return any_crossing(line, scene.outlines().chain(piece), false, scene.solids()[solid].solid.z,
                        [&](double at, const Vec2& end) {
                          crossings_.push_back({solid, at, end.x(), end.y()});
                          return false;
                        });
  });
  std::ranges::sort(crossings_);
  crossings_.erase(std::unique(crossings_.begin(), crossings_.end()), crossings_.end());
  int walls = 0;
  for (std::size_t first = 0; first < crossings_.size();) {
    std::size_t last = first + 1;
    while (last < crossings_.size() && crossings_[last].solid == crossings_[first].solid) ++last;
    walls += static_cast<int>((last - first + 1) / 2);
    first = last;
  }
  return walls;
}

bool LineCrossings::crosses_body(const SpatialLine& line, Row a, Row b) const {
  const auto is_hidden_by = [&](const BodyCircle& circle) {
    const Row row(circle.row);
    return line.passes_near(Vec2(circle.x, circle.y), circle.radius) && !view_->same_tree(row, a) &&
           !view_->same_tree(row, b) && hides(line, row);
  };
  if (are_bodies_gathered_) return std::ranges::any_of(bodies_, is_hidden_by);
  return any_piece(line, [&](const Box& box) {
    bool is_hidden = false;
    view_->index().for_each_near(
        box, [&](const BodyCircle& circle) { is_hidden = is_hidden || is_hidden_by(circle); });
    return is_hidden;
  });
}

bool LineCrossings::hides(const SpatialLine& line, Row row) const {
  const std::span<const Vec2> vertices = view_->outline(row);
  const double base = view_->poses()[row.index()].z;
  return std::ranges::any_of(view_->type(row).outlines, [&](const RayOutline& outline) {
    return any_crossing(line, vertices.subspan(outline.first, outline.count), true,
                        outline.z.shifted(base + view_->lift(row, outline.joint)),
                        [](double, const Vec2&) { return true; });
  });
}

}  // namespace troupe::engine
