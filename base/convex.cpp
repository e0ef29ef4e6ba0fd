#include "base/geometry.hpp"

#include <cstddef>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

/// A right turn by less than this (radians) counts as straight on: collinear corners computed in floating
/// point rarely lie exactly on one line.
constexpr double k_straight = 1e-9;
/// In this file heights and levels are y coordinates in the plane of the contours, not z. Corners whose
/// heights differ by at most this fraction of the largest coordinate get the same level.
constexpr double k_level = 1e-12;

/// True if the path a, b, c turns left or goes straight on at b; false if it turns straight back.
bool turns_left(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 in = b - a;
  const Vec2 out = c - b;
  const double turn = cross(in, out);
  return turn > 0 || (in.dot(out) > 0 && turn >= -k_straight * sqrt(in.squaredNorm() * out.squaredNorm()));
}

/// The ring without vertices that repeat the previous one.
Ring distinct(const Ring& ring) {
  Ring result;
  for (const Vec2& p : ring) {
    if (result.empty() || p != result.back()) result.push_back(p);
  }
  while (result.size() > 1 && result.front() == result.back()) result.pop_back();
  return result;
}

/// Sorts the items by ascending keys; items with equal keys keep their order, so that the result does not
/// depend on the implementation of sort. key_of: returns the key of an item, a pair of numbers
template <class Item, class KeyOf>
void sort_by(std::vector<Item>& items, KeyOf&& key_of) {
  std::vector<std::pair<std::pair<double, double>, std::size_t>> order;  // keys and indices
  order.reserve(items.size());
  for (const Item& item : items) order.emplace_back(key_of(item), order.size());
  std::stable_sort(order.begin(), order.end());
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const auto& [key, index] : order) sorted.push_back(items[index]);
  items = std::move(sorted);
}

// -- Trapezoids --

/// A contour edge that is not parallel to the x axis.
struct Side {
  Vec2 low;
  Vec2 high;

  double x_at(double y) const {
    if (y <= low.y()) return low.x();
    if (y >= high.y()) return high.x();
    const double t = (y - low.y()) / (high.y() - low.y());
    const double x = low.x() + t * (high.x() - low.x());
    return std::clamp(x, std::min(low.x(), high.x()), std::max(low.x(), high.x()));
  }
};

/// A part of the region: it lies between the two sides with the indices `left` and `right`, and between the
/// levels `bottom` and `top`.
struct Trapezoid {
  std::size_t left;
  std::size_t right;
  double bottom;
  double top;
};

/// Limits the work of one cut; spend() throws std::length_error when the limit is reached. Every pair of
/// sides may cross, and each crossing is a level at which all sides are cut. A few thousand maliciously
/// chosen corners would take days. Realistic outlines need a thousandth of the limit.
class Effort {
 public:
  void spend(std::size_t steps) {
    if (steps > left_)
      throw std::length_error(
          "the outline is too intricate to be cut into convex pieces; use fewer corners or fewer crossing "
          "edges");
    left_ -= steps;
  }

 private:
  std::size_t left_ = 50000000;
};

/// The heights in ascending order, without those within `tolerance` of the previous level.
std::vector<double> levels_of(std::vector<double> heights, double tolerance) {
  std::sort(heights.begin(), heights.end());
  std::vector<double> levels;
  for (const double y : heights) {
    if (levels.empty() || y - levels.back() > tolerance) levels.push_back(y);
  }
  return levels;
}

/// The level that stands for this height: the highest level that is not above it.
double level_of(const std::vector<double>& levels, double y) {
  return *std::prev(std::upper_bound(levels.begin(), levels.end(), y));
}

std::vector<double> corner_levels(const std::vector<Ring>& contours, double tolerance) {
  std::vector<double> heights;
  for (const Ring& contour : contours) {
    for (const Vec2& p : contour) heights.push_back(p.y());
  }
  return levels_of(std::move(heights), tolerance);
}

std::vector<Side> sides_of(const std::vector<Ring>& contours, const std::vector<double>& levels) {
  std::vector<Side> sides;
  for (const Ring& contour : contours) {
    for (std::size_t i = 0; i < contour.size(); ++i) {
      Vec2 a = contour[i];
      Vec2 b = contour[(i + 1) % contour.size()];
      a.y() = level_of(levels, a.y());
      b.y() = level_of(levels, b.y());
      if (a.y() < b.y()) sides.push_back({a, b});
      if (b.y() < a.y()) sides.push_back({b, a});
    }
  }
  // The sweep needs the sides in the order of their lower ends.
  sort_by(sides, [](const Side& side) { return std::pair(side.low.y(), 0.0); });
  return sides;
}

/// The heights between the levels `bottom` and `top` at which sides cross. `active`: the indices of the sides
/// that span both levels.
std::vector<double> crossings(const std::vector<Side>& sides, std::vector<std::size_t> active, double bottom,
                              double top, Effort& effort) {
  std::vector<double> heights;
  const auto x_bottom = [&](std::size_t s) { return sides[s].x_at(bottom); };
  const auto x_top = [&](std::size_t s) { return sides[s].x_at(top); };
  sort_by(active, [&](std::size_t s) { return std::pair(x_bottom(s), x_top(s)); });
  // Sorts the sides by their order at the top, by insertion. Each exchange is a pair of sides that cross.
  effort.spend(active.size());
  for (std::size_t i = 1; i < active.size(); ++i) {
    for (std::size_t j = i; j > 0 && x_top(active[j - 1]) > x_top(active[j]); --j) {
      const double gap_bottom = x_bottom(active[j]) - x_bottom(active[j - 1]);
      const double gap_top = x_top(active[j - 1]) - x_top(active[j]);
      heights.push_back(bottom + (top - bottom) * (gap_bottom / (gap_bottom + gap_top)));
      std::swap(active[j - 1], active[j]);
      effort.spend(1);
    }
  }
  return heights;
}

/// A slab is the space between two neighbouring levels, in which no sides cross. Appends the even-odd region
/// of a slab to `trapezoids`. Where a trapezoid of the slab below has the same two sides, that trapezoid is
/// extended instead. open: the indices of the trapezoids of the slab below; set to those of this slab.
void cut_slab(const std::vector<Side>& sides, std::vector<std::size_t> active, double bottom, double top,
              std::vector<Trapezoid>& trapezoids, std::vector<std::size_t>& open, Effort& effort) {
  effort.spend(4 * active.size());
  sort_by(active,
          [&](std::size_t s) { return std::pair(0.5 * (sides[s].x_at(bottom) + sides[s].x_at(top)), 0.0); });
  std::vector<std::size_t> now_open;
  auto candidate = open.begin();
  for (std::size_t i = 0; i + 1 < active.size(); i += 2) {
    const std::size_t left = active[i];
    const std::size_t right = active[i + 1];
    const auto same = std::find_if(candidate, open.end(), [&](std::size_t t) {
      return trapezoids[t].left == left && trapezoids[t].right == right;
    });
    effort.spend(static_cast<std::size_t>(same - candidate));
    if (same != open.end()) {
      trapezoids[*same].top = top;
      now_open.push_back(*same);
      candidate = std::next(same);
    } else {
      trapezoids.push_back({left, right, bottom, top});
      now_open.push_back(trapezoids.size() - 1);
    }
  }
  open = std::move(now_open);
}

std::vector<Trapezoid> trapezoids_of(const std::vector<Side>& sides, const std::vector<double>& levels,
                                     double tolerance) {
  Effort effort;
  std::vector<Trapezoid> trapezoids;
  std::vector<std::size_t> open;  // trapezoids that reach the top of the slab below, from left to right
  std::vector<std::size_t> active;
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    const double bottom = levels[k];
    const double top = levels[k + 1];
    std::erase_if(active, [&](std::size_t s) { return sides[s].high.y() <= bottom; });
    for (; next < sides.size() && sides[next].low.y() <= bottom; ++next) active.push_back(next);

    std::vector<double> cuts = crossings(sides, active, bottom, top, effort);
    cuts.push_back(bottom);
    cuts.push_back(top);
    cuts = levels_of(std::move(cuts), tolerance);
    cuts.back() = top;  // a crossing within the tolerance below `top` is merged into it
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      cut_slab(sides, active, cuts[i], cuts[i + 1], trapezoids, open, effort);
    }
  }
  return trapezoids;
}

// -- Merging --

/// A convex piece, which is extended upwards: its left vertices and its right vertices, both from bottom to
/// top.
struct Piece {
  Ring left;
  Ring right;
};

bool continues(const Piece& piece, const Piece& above) {
  const auto straight_or_in = [](const Ring& chain, const Ring& next, bool left) {
    const Vec2& a = chain[chain.size() - 2];
    const Vec2& b = chain.back();
    return left ? turns_left(next[1], b, a) : turns_left(a, b, next[1]);
  };
  return piece.left.back() == above.left.front() && piece.right.back() == above.right.front() &&
         straight_or_in(piece.left, above.left, true) && straight_or_in(piece.right, above.right, false);
}

/// Joins each trapezoid to the piece that ends at its bottom if their union is convex. Works greedily from
/// bottom to top, so the number of pieces is not minimal.
std::vector<Piece> merged(const std::vector<Side>& sides, std::vector<Trapezoid> trapezoids,
                          double tolerance) {
  std::vector<Piece> pieces;
  // Trapezoids of one slab stay in order from left to right.
  sort_by(trapezoids, [](const Trapezoid& trapezoid) { return std::pair(trapezoid.bottom, 0.0); });
  // Maps the height and left end of a piece's top to the piece, to find the piece below a trapezoid.
  std::map<std::pair<double, double>, std::size_t> by_top;
  for (const Trapezoid& t : trapezoids) {
    Piece above;
    for (const double y : {t.bottom, t.top}) {
      const double left = sides[t.left].x_at(y);
      above.left.emplace_back(left, y);
      above.right.emplace_back(std::max(left, sides[t.right].x_at(y)), y);
    }
    const double width_bottom = above.right[0].x() - above.left[0].x();
    const double width_top = above.right[1].x() - above.left[1].x();
    if (std::max(width_bottom, width_top) <= tolerance) continue;

    const auto found = by_top.find({t.bottom, above.left[0].x()});
    if (found != by_top.end() && width_bottom > 0 && continues(pieces[found->second], above)) {
      const std::size_t piece = found->second;
      pieces[piece].left.push_back(above.left[1]);
      pieces[piece].right.push_back(above.right[1]);
      by_top.erase(found);
      by_top.insert_or_assign({t.top, above.left[1].x()}, piece);
    } else {
      by_top.insert_or_assign({t.top, above.left[1].x()}, pieces.size());
      pieces.push_back(std::move(above));
    }
  }
  return pieces;
}

/// The piece as a counter-clockwise ring.
Ring outline_of(const Piece& piece) {
  Ring ring = piece.right;
  ring.insert(ring.end(), piece.left.rbegin(), piece.left.rend());
  return distinct(ring);
}

// -- Directions --

/// A rotation of the plane with a scale: turns contours before and pieces after a cut, because all cuts are
/// parallel to the x axis.
struct Direction {
  double c;  // scale * cosine
  double s;  // scale * sine

  Vec2 turned(const Vec2& v) const { return {c * v.x() - s * v.y(), s * v.x() + c * v.y()}; }
  Direction inverse() const { return {c / (c * c + s * s), -s / (c * c + s * s)}; }
};
Ring turned(Ring ring, const Direction& direction) {
  for (Vec2& v : ring) v = direction.turned(v);
  return ring;
}

/// The convex pieces of the even-odd region of the contours, cut along the x axis.
std::vector<Ring> cut(const std::vector<Ring>& contours) {
  Box box;
  for (const Ring& contour : contours) box.extend(bounds(contour));
  const double extent = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
  const double tolerance = k_level * extent;
  const std::vector<double> levels = corner_levels(contours, tolerance);
  const std::vector<Side> sides = sides_of(contours, levels);
  std::vector<Ring> outlines;
  for (const Piece& piece : merged(sides, trapezoids_of(sides, levels, tolerance), tolerance)) {
    Ring outline = outline_of(piece);
    if (outline.size() >= 3 && signed_area(outline) > 0) outlines.push_back(std::move(outline));
  }
  return outlines;
}
std::vector<Ring> cut(const std::vector<Ring>& contours, const Direction& direction) {
  std::vector<Ring> turned_contours;
  for (const Ring& contour : contours) turned_contours.push_back(turned(contour, direction));
  std::vector<Ring> outlines = cut(turned_contours);
  for (Ring& outline : outlines) outline = turned(std::move(outline), direction.inverse());
  return outlines;
}

double smallest_width(const std::vector<Ring>& outlines) {
  double width = std::numeric_limits<double>::infinity();
  for (const Ring& outline : outlines) width = std::min(width, convex_width(outline));
  return width;
}

}  // namespace

std::size_t count_vertices(const std::vector<Solid>& solids) {
  std::size_t count = 0;
  for (const Solid& solid : solids)
    for (const Ring& ring : solid.contours) count += ring.size();
  return count;
}

Solid placed(Solid solid, const Pose& pose_world_body) {
  const Transform transform(pose_world_body);
  for (Ring& ring : solid.contours)
    for (Vec2& v : ring) v = transform * v;
  solid.z = solid.z.shifted(pose_world_body.z);
  return solid;
}

double signed_area(const Ring& ring) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    twice += cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
  }
  return 0.5 * twice;
}

Box bounds(const Ring& ring) {
  Box box;
  for (const Vec2& p : ring) box.extend(p);
  return box;
}

bool is_convex(const Ring& ring) {
  const Ring corners = distinct(ring);
  const std::size_t n = corners.size();
  if (n < 3 || !(signed_area(corners) > 0)) return false;
  // A pentagram also turns left at every corner. A convex ring turns by one full turn in total, a pentagram
  // by two.
  double turned = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& corner = corners[(i + 1) % n];
    const Vec2& next = corners[(i + 2) % n];
    if (!turns_left(corners[i], corner, next)) return false;
    const Vec2 in = corner - corners[i];
    const Vec2 out = next - corner;
    turned += atan2(cross(in, out), in.dot(out));
  }
  return turned < 3 * k_pi;
}

double convex_width(const Ring& ring) {
  const Ring corners = distinct(ring);
  if (corners.size() < 3) return 0;
  double width = std::numeric_limits<double>::infinity();
  // The width of a convex polygon is least for two lines of which one runs along an edge.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 edge = corners[(i + 1) % corners.size()] - corners[i];
    double farthest = 0;
    for (const Vec2& p : corners) farthest = std::max(farthest, cross(edge, p - corners[i]));
    width = std::min(width, farthest / sqrt(edge.squaredNorm()));
  }
  return width;
}

bool contains(const Solid& solid, const Vec2& point) {
  bool inside = false;
  for (const Ring& contour : solid.contours) {
    for (std::size_t i = 0; i < contour.size(); ++i)
      inside ^= crosses_ray(contour[i], contour[(i + 1) % contour.size()], point);
  }
  return inside;
}

std::vector<ConvexPrism> convex_pieces(const Solid& solid) {
  std::vector<Ring> contours;
  for (const Ring& contour : solid.contours) {
    Ring corners = distinct(contour);
    if (corners.size() >= 3) contours.push_back(std::move(corners));
  }
  if (contours.empty()) return {};

  std::vector<ConvexPrism> prisms;
  if (contours.size() == 1) {
    Ring& outline = contours.front();
    if (signed_area(outline) < 0) std::reverse(outline.begin(), outline.end());
    if (is_convex(outline)) {
      prisms.push_back({std::move(outline), solid.z});
      return prisms;
    }
  }

  std::vector<Ring> outlines = cut(contours);
  // Two corners at almost the same height leave a sliver between their cuts. Cuts in other directions may
  // avoid it. Neither direction changes the coordinates by more than rounding.
  for (const Direction& direction : {Direction{0, 1}, Direction{1, 1}}) {
    const double width = smallest_width(outlines);
    if (width >= k_thin_m) break;
    try {
      std::vector<Ring> others = cut(contours, direction);
      if (!others.empty() && smallest_width(others) > width) outlines = std::move(others);
    } catch (const std::length_error&) {  // too intricate only in this direction
    }
  }
  for (Ring& outline : outlines) prisms.push_back({std::move(outline), solid.z});
  return prisms;
}

}  // namespace troupe
