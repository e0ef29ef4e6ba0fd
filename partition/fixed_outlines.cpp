#include "partition/fixed_outlines.hpp"

#include "base/geometry.hpp"
#include "base/math.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::partition {
namespace {

constexpr unsigned k_tile_bits = 3;

struct PieceCircle {
  Vec2 center;
  double radius;
  std::uint32_t piece;
};

}  // namespace

FixedOutlines::FixedOutlines(std::span<const FixedEdge> edges, double piece_m)
    : geometry_{piece_m, k_tile_bits} {
  edges_.reserve(edges.size());
  for (const FixedEdge& edge : edges) edges_.push_back({edge.a, edge.b});
  const double most = 0.5 * piece_m;
  std::vector<PieceCircle> circles;
  const auto close = [&](const Box& box, std::uint32_t first, std::uint32_t count) {
    const auto piece = static_cast<std::uint32_t>(pieces_.size());
    pieces_.push_back({first, count, edges[first].solid});
    if (count > 1 || 0.5 * (edges_[first].b - edges_[first].a).norm() <= most) {
      circles.push_back({box.center(), 0.5 * box.size().norm(), piece});
      return;
    }
    const Ends& edge = edges_[first];
    const double length = (edge.b - edge.a).norm();
    const auto parts = static_cast<std::uint32_t>(std::clamp(length / (2 * most) + 1, 1.0, 1e6));
    // Whether a beam passes an edge is known to float rounding at its ends, so far ends count.
    constexpr double k_ends = 8e-6;
    for (std::uint32_t i = 0; i < parts; ++i)
      circles.push_back(
          {edge.a + (i + 0.5) / parts * (edge.b - edge.a), 0.5 * length / parts + k_ends * length, piece});
  };
  Box box;
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    Box wider = box;
    wider.extend(edges_[i].a);
    wider.extend(edges_[i].b);
    const bool joins = i > first && edges[i].solid == edges[first].solid && i - first < k_most_edges &&
                       0.5 * wider.size().norm() <= most;
    if (!joins) {
      if (i > first) close(box, first, i - first);
      first = i;
      wider = Box();
      wider.extend(edges_[i].a);
      wider.extend(edges_[i].b);
    }
    box = wider;
  }
  if (first < edges_.size()) close(box, first, static_cast<std::uint32_t>(edges_.size()) - first);

  // A counting sort by cell.
  const std::size_t cells = geometry_.cells_per_tile();
  for (const PieceCircle& c : circles) {
    directory_.insert(geometry_.tile(geometry_.cell(c.center)));
    largest_radius_ = std::max(largest_radius_, c.radius);
  }
  begins_.assign(directory_.size() * cells + 1, 0);
  const auto place = [&](const PieceCircle& c) {
    const Cell cell = geometry_.cell(c.center);
    return directory_.find(geometry_.tile(cell)) * cells + geometry_.in_tile(cell);
  };
  for (const PieceCircle& c : circles) ++begins_[place(c) + 1];
  for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
  circles_.resize(circles.size());
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (const PieceCircle& c : circles)
    circles_[next[place(c)]++] = enclosing_circle(c.center, c.radius, c.piece);
}

}  // namespace troupe::partition
