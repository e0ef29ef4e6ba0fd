#include "worldio/json/wall_line.hpp"

#include "base/math.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace troupe::worldio {
namespace {

/// Cosine of the largest turn at a point. The mitre of a sharper turn would be longer than 7.7 times half the
/// thickness.
constexpr double k_least_cosine = -0.966;

/// A line without its closing point, and the corners of the walls on both sides of each of its points.
class WallCorners {
 public:
  WallCorners(const Ring& line, double thickness)
      : line_(line), half_(thickness / 2), closed_(is_closed(line)) {
    if (closed_) line_.pop_back();
    for (std::size_t i = 0; i < line_.size(); ++i) {
      const Vec2 offset = mitre(i);
      left_.push_back(line_[i] + offset);
      right_.push_back(line_[i] - offset);
    }
  }

  std::size_t segments() const { return closed_ ? line_.size() : line_.size() - 1; }
  std::size_t end(std::size_t segment) const { return (segment + 1) % line_.size(); }
  Vec2 direction(std::size_t segment) const { return (line_[end(segment)] - line_[segment]).normalized(); }
  const Vec2& left(std::size_t point) const { return left_[point]; }
  const Vec2& right(std::size_t point) const { return right_[point]; }

 private:
  /// Returns the vector from a point to the corner on its left. The distance of this corner from both
  /// segments at the point is half the thickness.
  Vec2 mitre(std::size_t point) const {
    const auto left_of = [this](std::size_t segment) {
      const Vec2 along = direction(segment);
      return Vec2(-along.y(), along.x());
    };
    const bool is_first = !closed_ && point == 0;
    const bool is_last = !closed_ && point + 1 == line_.size();
    if (is_first || is_last) return half_ * left_of(is_first ? 0 : point - 1);
    const Vec2 before = left_of((point + segments() - 1) % segments());
    const Vec2 after = left_of(point);
    return half_ / (1 + before.dot(after)) * (before + after);
  }

  Ring line_;
  double half_;
  bool closed_;
  Ring left_, right_;
};

}  // namespace

bool is_closed(const Ring& line) { return line.size() > 2 && line.front() == line.back(); }

Result<> check_wall_line(const Ring& line, double thickness) {
  for (std::size_t i = 1; i < line.size(); ++i)
    if (line[i] == line[i - 1])
      return Error{
          fmt::format("point {} repeats point {} (points are counted from 0): remove one of the two, because "
                      "a wall of length 0 is not allowed",
                      i, i - 1)};
  const bool closed = line.size() > 2 && line.front() == line.back();
  const std::size_t points = closed ? line.size() - 1 : line.size();
  for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < points; ++i) {
    const Vec2 before = line[i] - line[(i + points - 1) % points];
    const Vec2 after = line[(i + 1) % points] - line[i];
    if (before.dot(after) < k_least_cosine * before.norm() * after.norm())
      return Error{fmt::format(
          "the line turns back on itself at point {}, counted from 0: a line may turn by at most 165 degrees",
          i)};
  }
  const WallCorners corners(line, thickness);
  for (std::size_t i = 0; i < corners.segments(); ++i) {
    const std::size_t end = corners.end(i);
    const Vec2 along = corners.direction(i);
    if ((corners.left(end) - corners.left(i)).dot(along) <= 0 ||
        (corners.right(end) - corners.right(i)).dot(along) <= 0)
      return Error{
          fmt::format("the segment that begins at point {}, counted from 0, is too short for walls {:.10g} m "
                      "thick: move this point, or make the walls thinner",
                      i, thickness)};
  }
  return {};
}

std::vector<Solid> wall_solids(const Ring& line, double thickness, double height) {
  const WallCorners corners(line, thickness);
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < corners.segments(); ++i) {
    const std::size_t end = corners.end(i);
    solids.push_back(
        {{{corners.right(i), corners.right(end), corners.left(end), corners.left(i)}}, {0, height}});
  }
  return solids;
}

}  // namespace troupe::worldio
