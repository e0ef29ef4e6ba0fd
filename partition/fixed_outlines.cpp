#include "partition/fixed_outlines.hpp"

#include "base/geometry.hpp"
#include "base/math.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::partition {
namespace {

constexpr unsigned k_tile_bits = 3;

struct ChainCircle {
  Vec2 center;
  double radius;
  std::uint32_t piece;
};

}  // namespace

FixedOutlines::FixedOutlines(std::span<const FixedEdge> edges, double piece_m)
    : geometry_{piece_m, k_tile_bits} {
  vertices_.reserve(edges.size() + edges.size() / k_most_edges);
  const double most = 0.5 * piece_m;
  std::vector<ChainCircle> circles;
  const auto close = [&](const Box& box, std::uint32_t first, std::uint32_t count) {
    const auto piece = static_cast<std::uint32_t>(pieces_.size());
    pieces_.push_back({static_cast<std::uint32_t>(vertices_.size()), count + 1, edges[first].solid});
    vertices_.push_back(edges[first].a);
    for (const FixedEdge& edge : edges.subspan(first, count)) vertices_.push_back(edge.b);
    const FixedEdge& edge = edges[first];
    const double length = (edge.b - edge.a).norm();
    if (count > 1 || 0.5 * length <= most) {
      circles.push_back({box.center(), 0.5 * box.size().norm(), piece});
      return;
    }
    const auto parts = static_cast<std::uint32_t>(std::clamp(length / (2 * most) + 1, 1.0, 1e6));
    // Because of rounding to float, a beam may hit an edge slightly beyond its end. The circles are enlarged
    // to cover this error.
    constexpr double k_ends = 8e-6;  // the error, as a fraction of the length of the edge
    for (std::uint32_t i = 0; i < parts; ++i)
      circles.push_back(
          {edge.a + (i + 0.5) / parts * (edge.b - edge.a), 0.5 * length / parts + k_ends * length, piece});
  };
  Box box;
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    Box wider = box;
    wider.extend(edges[i].a);
    wider.extend(edges[i].b);
    const bool joins = i > first && edges[i].solid == edges[first].solid && edges[i].a == edges[i - 1].b &&
                       i - first < k_most_edges && 0.5 * wider.size().norm() <= most;
    if (!joins) {
      if (i > first) close(box, first, i - first);
      first = i;
      wider = Box();
      wider.extend(edges[i].a);
      wider.extend(edges[i].b);
    }
    box = wider;
  }
  if (first < edges.size()) close(box, first, static_cast<std::uint32_t>(edges.size()) - first);

  vertices_.resize(vertices_.size() + k_most_edges,
                   Vec2::Zero());  // EdgeBlock::add() reads beyond the end of a chain

  // The circles are sorted by cell with a counting sort.
  const std::size_t cells = geometry_.cells_per_tile();
  for (const ChainCircle& c : circles) {
    directory_.insert(geometry_.tile(geometry_.cell(c.center)));
    largest_radius_ = std::max(largest_radius_, c.radius);
  }
  begins_.assign(directory_.size() * cells + 1, 0);
  const auto place = [&](const ChainCircle& c) {
    const Cell cell = geometry_.cell(c.center);
    return directory_.find(geometry_.tile(cell)) * cells + geometry_.in_tile(cell);
  };
  for (const ChainCircle& c : circles) ++begins_[place(c) + 1];
  for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
  circles_.resize(circles.size() + 3);  // unpack() may read three more
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (const ChainCircle& c : circles)
    circles_[next[place(c)]++] = enclosing_circle(c.center, c.radius, c.piece);
}

}  // namespace troupe::partition
