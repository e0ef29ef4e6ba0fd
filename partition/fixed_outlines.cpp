#include "partition/fixed_outlines.hpp"

#include "base/geometry.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {
namespace {

constexpr unsigned k_tile_bits = 3;

/// Consecutive edges that form one piece, and their bounding box.
struct Chain {
  std::span<const FixedEdge> edges;
  Box box;
};

/// A circle that contains a piece or a part of it.
struct ChainCircle {
  Vec2 center;
  double radius;
  std::uint32_t piece;
};

/// Divides edges into chains. A chain is as long as possible, but has at most k_most_edges edges. If it has
/// several edges, half the diagonal of its bounding box is at most `most`, m.
std::vector<Chain> chains_of(std::span<const FixedEdge> edges, double most) {
  std::vector<Chain> chains;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const FixedEdge& edge = edges[i];
    const auto with_edge = [&](Box box) {
      box.extend(edge.a);
      box.extend(edge.b);
      return box;
    };
    if (!chains.empty()) {
      Chain& last = chains.back();
      const Box wider = with_edge(last.box);
      if (edge.solid == last.edges.front().solid && edge.a == last.edges.back().b &&
          last.edges.size() < FixedOutlines::k_most_edges && 0.5 * wider.size().norm() <= most) {
        last = {{last.edges.data(), last.edges.size() + 1}, wider};
        continue;
      }
    }
    chains.push_back({edges.subspan(i, 1), with_edge(Box())});
  }
  return chains;
}

/// Appends circles that together contain a chain, the piece with the index `piece`. The circles of a single
/// edge longer than 2 * most have radii of about `most`, m.
void add_circles(const Chain& chain, double most, std::uint32_t piece, std::vector<ChainCircle>& circles) {
  const FixedEdge& edge = chain.edges.front();
  const double length = (edge.b - edge.a).norm();
  if (chain.edges.size() > 1 || 0.5 * length <= most) {
    circles.push_back({chain.box.center(), 0.5 * chain.box.size().norm(), piece});
    return;
  }
  const auto parts = static_cast<std::uint32_t>(std::clamp(length / (2 * most) + 1, 1.0, 1e6));
  // Because of rounding to float, a beam may hit an edge slightly beyond its end. The circles are enlarged
  // to cover this error.
  constexpr double k_ends = 8e-6;  // the error, as a fraction of the length of the edge
  for (std::uint32_t i = 0; i < parts; ++i)
    circles.push_back(
        {edge.a + (i + 0.5) / parts * (edge.b - edge.a), 0.5 * length / parts + k_ends * length, piece});
}

}  // namespace

FixedOutlines::FixedOutlines(std::span<const FixedEdge> edges, double piece_m)
    : geometry_{piece_m, k_tile_bits} {
  vertices_.reserve(edges.size() + edges.size() / k_most_edges);
  const double most = 0.5 * piece_m;
  std::vector<ChainCircle> circles;
  for (const Chain& chain : chains_of(edges, most)) {
    const auto piece = static_cast<std::uint32_t>(pieces_.size());
    pieces_.push_back({static_cast<std::uint32_t>(vertices_.size()),
                       static_cast<std::uint32_t>(chain.edges.size() + 1), chain.edges.front().solid});
    vertices_.push_back(chain.edges.front().a);
    for (const FixedEdge& edge : chain.edges) vertices_.push_back(edge.b);
    add_circles(chain, most, piece, circles);
  }
  // EdgeBlock::add() reads beyond the end of a chain.
  vertices_.resize(vertices_.size() + k_most_edges, Vec2::Zero());

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
