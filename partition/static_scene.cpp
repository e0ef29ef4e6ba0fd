#include "partition/static_scene.hpp"

#include "base/sort.hpp"
#include "partition/separation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace troupe::partition {
namespace {

constexpr double k_least_cover_m = 0.25;  // smaller cells of Strips::covers would classify few more points

/// Returns the largest number of entries that an index of this many edges should have. It is far above the
/// number of entries that the edges of rooms and furniture have. Without it, a few walls of 100 km among
/// robots of 2 cm would have tens of millions of entries.
double most_entries(std::size_t edges) {
  constexpr double k_for_all = 1 << 21;
  constexpr double k_per_edge = 8;
  return k_for_all + k_per_edge * static_cast<double>(edges);
}

/// Returns the edge of the cells, m, for an index that lists each edge in the cells that it crosses: cell_m,
/// or if the index would then have too many entries, cell_m times a power of two.
double sparse_cell(std::span<const FixedEdge> edges, double cell_m) {
  double length = 0;
  for (const FixedEdge& edge : edges) length += (edge.b - edge.a).lpNorm<1>();
  while (length / cell_m > most_entries(edges.size())) cell_m *= 2;
  return cell_m;
}

/// Returns the number of strips, not rounded, into which a solid of this height (m) is divided if no limit
/// demands fewer.
double fine_strips(double height, double strip_m) { return std::clamp(height / strip_m, 1.0, 4096.0); }

/// Visits the cells that an edge may cross: those of its bounding box, except cells whose centre is farther
/// from the line of the edge than half the diagonal of a cell. A few cells too many do no harm.
template <class Visit>
void for_each_cell(const GridGeometry& grid, const FixedEdge& edge, Visit&& visit) {
  const Cell low = grid.cell(edge.a.cwiseMin(edge.b));
  const Cell high = grid.cell(edge.a.cwiseMax(edge.b));
  const Vec2 along = edge.b - edge.a;
  const double reach = 0.7072 * grid.cell_m * along.norm() * (1 + 1e-9);
  for (std::int32_t y = low.y; y <= high.y; ++y) {
    Cell from = low;
    Cell to = high;
    // In this row of cells, only those that the edge passes and one more on each side are tested.
    if (along.y() != 0) {
      const double t0 = std::clamp((y * grid.cell_m - edge.a.y()) / along.y(), 0.0, 1.0);
      const double t1 = std::clamp(((y + 1) * grid.cell_m - edge.a.y()) / along.y(), 0.0, 1.0);
      const Vec2 p = edge.a + t0 * along;
      const Vec2 q = edge.a + t1 * along;
      from.x = std::max(low.x, grid.cell(p.cwiseMin(q)).x - 1);
      to.x = std::min(high.x, grid.cell(p.cwiseMax(q)).x + 1);
    }
    for (std::int32_t x = from.x; x <= to.x; ++x) {
      const Vec2 middle((x + 0.5) * grid.cell_m, (y + 0.5) * grid.cell_m);
      const double side = cross(along, middle - edge.a);
      if (side <= reach && side >= -reach) visit(Cell{x, y});
    }
  }
}

template <class Visit>
void for_each_edge(const Solid& solid, Visit&& visit) {
  for (const Ring& ring : solid.contours)
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) visit(ring[j], ring[i]);
}

}  // namespace

EdgeGrid::EdgeGrid(std::span<const FixedEdge> edges, const GridGeometry& geometry) : geometry_(geometry) {
  const std::size_t cells = geometry_.cells_per_tile();
  std::vector<std::uint32_t> counts;
  const auto count_cell = [&](Cell c) -> std::uint32_t& {
    const std::uint32_t slot = directory_.insert(geometry_.tile(c));
    if (counts.size() < (slot + 1) * cells) counts.resize((slot + 1) * cells, 0);
    return counts[slot * cells + geometry_.in_tile(c)];
  };
  for (const FixedEdge& edge : edges) for_each_cell(geometry_, edge, [&](Cell c) { ++count_cell(c); });
  begins_.assign(counts.size() + 1, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) begins_[i + 1] = begins_[i] + counts[i];
  edges_.resize(begins_.back());
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (const FixedEdge& edge : edges) {
    for_each_cell(geometry_, edge, [&](Cell c) {
      const std::uint32_t slot = directory_.find(geometry_.tile(c));
      edges_[next[slot * cells + geometry_.in_tile(c)]++] = edge;
    });
  }
}

/// Classifies the cells of a solid's box as inside or outside the solid, or as unknown if an edge may cross
/// the cell. A cell that no edge crosses is wholly inside or wholly outside. If two such cells are next to
/// each other, both are inside or both are outside. In each row of cells, edges are therefore counted only
/// for the first cell of a sequence of such cells. If the box has more than 2^20 cells, or more than `room`,
/// `covers` stays empty. The number of cells is subtracted from `room`.
void StaticScene::cover_cells(const Solid& solid, Strips& strips, double& room) const {
  constexpr double k_most_cells = 1 << 20;
  const Cell low = cover_grid_.cell(strips.box.min);
  const Cell high = cover_grid_.cell(strips.box.max);
  const double columns = 1.0 + high.x - low.x;
  const double rows = 1.0 + high.y - low.y;
  if (columns * rows > std::min(k_most_cells, room)) return;
  room -= columns * rows;
  strips.low = low;
  strips.width = static_cast<std::size_t>(columns);
  strips.covers.assign(strips.width * static_cast<std::size_t>(rows), Strips::outside);
  for_each_edge(solid, [&](const Vec2& a, const Vec2& b) {
    for_each_cell(cover_grid_, {a, b, 0}, [&](Cell c) {
      strips.covers[static_cast<std::size_t>(c.y - low.y) * strips.width +
                    static_cast<std::size_t>(c.x - low.x)] = Strips::unknown;
    });
  });
  for (std::size_t i = 0; i < strips.covers.size(); ++i) {
    Strips::Cover& cover = strips.covers[i];
    if (cover == Strips::unknown) continue;
    const std::size_t column = i % strips.width;
    const std::size_t row = i / strips.width;
    if (column > 0 && strips.covers[i - 1] != Strips::unknown) {
      cover = strips.covers[i - 1];
    } else {
      const Vec2 middle((static_cast<double>(low.x) + static_cast<double>(column) + 0.5) * cover_grid_.cell_m,
                        (static_cast<double>(low.y) + static_cast<double>(row) + 0.5) * cover_grid_.cell_m);
      cover = count_crossings(strips, middle) ? Strips::inside : Strips::outside;
    }
  }
}

std::size_t StaticScene::Strips::strip_at(double y) const {
  return static_cast<std::size_t>(std::clamp((y - y0) / height, 0.0, static_cast<double>(begins.size() - 2)));
}

/// Divides the box of a solid, strips.box, into this many strips and sorts the edges of the solid into them.
/// index: index of the solid in solids().
void StaticScene::sort_into_strips(std::uint32_t index, std::size_t count, Strips& strips) const {
  const double height = strips.box.size().y();
  strips.y0 = strips.box.min.y();
  strips.height = std::max(height / static_cast<double>(count), 1e-9);
  strips.begins.assign(count + 1, 0);
  const auto for_each_strip = [&](auto&& visit) {
    for_each_edge(solids_[index].solid, [&](const Vec2& a, const Vec2& b) {
      if (a.y() == b.y()) return;
      const std::size_t last = strips.strip_at(std::max(a.y(), b.y()));
      for (std::size_t i = strips.strip_at(std::min(a.y(), b.y())); i <= last; ++i)
        visit(i, FixedEdge{a, b, index});
    });
  };
  for_each_strip([&](std::size_t strip, const FixedEdge&) { ++strips.begins[strip + 1]; });
  for (std::size_t i = 0; i < count; ++i) strips.begins[i + 1] += strips.begins[i];
  strips.edges.resize(strips.begins.back());
  std::vector<std::uint32_t> next = strips.begins;
  for_each_strip([&](std::size_t strip, const FixedEdge& edge) { strips.edges[next[strip]++] = edge; });
  for (std::size_t i = 0; i < count; ++i)  // from left to right, so that count_crossings() can stop early
    std::sort(strips.edges.begin() + strips.begins[i], strips.edges.begin() + strips.begins[i + 1],
              [](const FixedEdge& e, const FixedEdge& f) {
                return std::min(e.a.x(), e.b.x()) < std::min(f.a.x(), f.b.x());
              });
}

StaticScene::StaticScene(std::vector<FixedSolid> solids, double cell_m) : solids_(std::move(solids)) {
  cover_grid_ = {std::max(cell_m, k_least_cover_m), 0};
  pieces_ = std::shared_ptr<Pieces[]>(new Pieces[solids_.size()]);
  strips_.resize(solids_.size());
  std::vector<FixedEdge> seen;
  std::vector<FixedEdge> hidden;
  std::vector<FixedEdge> hard;
  std::vector<Box> boxes(solids_.size());
  std::vector<Box> obstacle_boxes(solids_.size());
  double strip_entries = 0;  // estimated number of entries of all Strips
  for (std::uint32_t s = 0; s < solids_.size(); ++s) {
    const FixedSolid& fixed = solids_[s];
    Box& box = boxes[s];
    double climb = 0;  // sum of the heights of the edges, m
    for_each_edge(fixed.solid, [&](const Vec2& a, const Vec2& b) {
      ++edge_count_;
      box.extend(a);
      climb += std::abs(b.y() - a.y());
      if (a == b) return;
      (fixed.ranger_return >= 0 ? seen : hidden).push_back({a, b, s});
      if (fixed.obstacle) hard.push_back({a, b, s});
    });
    if (box.empty()) continue;
    bounds_.extend(box);
    strips_[s].box = box;
    if (!fixed.obstacle) continue;
    has_obstacles_ = true;
    obstacle_boxes[s] = box;
    if (const double height = box.size().y(); height > 0)
      strip_entries += climb / height * fine_strips(height, cell_m);
  }
  // Fewer strips and covered cells slow down searches, but change no result.
  const double coarsening = std::max(strip_entries / most_entries(hard.size()), 1.0);
  double cover_room = 1 << 26;  // cells of the Strips::covers of all solids; a cell takes a byte
  for (std::uint32_t s = 0; s < solids_.size(); ++s) {
    if (!solids_[s].obstacle) continue;
    const double strips = fine_strips(obstacle_boxes[s].size().y(), cell_m) / coarsening;
    sort_into_strips(s, static_cast<std::size_t>(std::max(strips, 1.0)), strips_[s]);
    cover_cells(solids_[s].solid, strips_[s], cover_room);
  }
  constexpr double k_piece = 4;  // the argument piece_m of FixedOutlines, in cells
  outlines_ = FixedOutlines(seen, sparse_cell(seen, k_piece * cell_m));
  hidden_outlines_ = FixedOutlines(hidden, sparse_cell(hidden, k_piece * cell_m));
  boxes_ = BoxGrid(boxes);
  obstacle_boxes_ = BoxGrid(obstacle_boxes);
  obstacle_edges_ = EdgeGrid(hard, GridGeometry{sparse_cell(hard, cell_m), 3});
}

double StaticScene::clearance(const Vec2& point, double most) const {
  double nearest2 = most * most;
  obstacle_edges_.for_each_run(Box::around(point, most), [&](std::span<const FixedEdge> edges) {
    for (const FixedEdge& edge : edges)
      nearest2 = std::min(nearest2, squared_distance_to_segment(point, edge.a, edge.b));
  });
  return sqrt(nearest2);
}

bool StaticScene::inside(std::size_t solid, const Vec2& p) const {
  const Strips& strips = strips_[solid];
  if (strips.edges.empty() || !strips.box.contains(p)) return false;
  if (!strips.covers.empty()) {
    const Cell c = cover_grid_.cell(p);
    const Strips::Cover cover = strips.covers[static_cast<std::size_t>(c.y - strips.low.y) * strips.width +
                                              static_cast<std::size_t>(c.x - strips.low.x)];
    if (cover != Strips::unknown) return cover == Strips::inside;
  }
  return count_crossings(strips, p);
}

bool StaticScene::count_crossings(const Strips& strips, const Vec2& p) const {
  const std::size_t strip = strips.strip_at(p.y());
  bool odd = false;
  for (std::uint32_t i = strips.begins[strip]; i < strips.begins[strip + 1]; ++i) {
    const FixedEdge& e = strips.edges[i];
    if (std::min(e.a.x(), e.b.x()) > p.x()) break;
    if ((e.a.y() > p.y()) == (e.b.y() > p.y())) continue;
    const double side = cross(e.b - e.a, p - e.a);
    if ((e.b.y() > e.a.y()) == (side < 0)) odd = !odd;  // the edge lies left of the point
  }
  return odd;
}

bool StaticScene::swallows(std::size_t solid, const PlacedShape& placed) const {
  const ObstacleShape& shape = placed.shape();
  if (!solids_[solid].obstacle || !strips_[solid].box.touches(Box::around(placed.position(), shape.radius)))
    return false;
  for (const ConvexPrism& piece : shape.pieces) {
    if (!piece.z.shifted(placed.z()).overlaps(solids_[solid].solid.z)) continue;
    Vec2 middle = Vec2::Zero();
    for (const Vec2& v : piece.outline) middle += v;
    if (inside(solid, placed.transform() * (middle / static_cast<double>(piece.outline.size())))) return true;
  }
  return false;
}

bool StaticScene::overlaps_solid(std::size_t solid, const PlacedShape& shape) const {
  return find_crossing(shape, [&](const FixedEdge& edge) { return edge.solid == solid; }) ||
         swallows(solid, shape);
}

bool StaticScene::overlaps(const PlacedShape& shape) const {
  return find_crossing(shape, [](const FixedEdge&) { return true; }) ||
         find_swallowing(shape, [](std::uint32_t) { return true; });
}

bool StaticScene::deepens(const PlacedShape& before, const PlacedShape& after) const {
  std::uint32_t passed = ~0u;  // many edges of the same solid follow one another
  const auto is_deeper = [&](std::uint32_t solid) {
    if (solid == passed) return false;
    passed = solid;
    return deepens_in(solid, before, after);
  };
  return find_crossing(after, [&](const FixedEdge& edge) { return is_deeper(edge.solid); }) ||
         find_swallowing(after, is_deeper);
}

bool StaticScene::deepens_in(std::size_t solid, const PlacedShape& before, const PlacedShape& after) const {
  const ObstacleShape& pieces = pieces_of(solid);
  return pieces.empty() || partition::deepens(before, after, PlacedShape(pieces, Transform(), 0));
}

bool StaticScene::is_near_segment(BodyId body, const Vec2& a, const Vec2& b, double distance,
                                  const ZInterval& z) const {
  Box box;
  box.extend(a);
  box.extend(b);
  const auto counts = [&](std::uint32_t solid) {
    return solids_[solid].body == body && solids_[solid].solid.z.overlaps(z);
  };
  bool is_near = false;
  obstacle_edges_.for_each_run(box.expanded(distance), [&](std::span<const FixedEdge> edges) {
    is_near = is_near || std::ranges::any_of(edges, [&](const FixedEdge& edge) {
                return counts(edge.solid) && segment_distance(a, b, edge.a, edge.b) <= distance;
              });
  });
  return is_near || obstacle_boxes_.any_near(
                        box, [&](std::uint32_t solid) { return counts(solid) && inside(solid, a); });
}

BodyId StaticScene::blocker(const PlacedShape& before, const PlacedShape& after) const {
  BodyId lowest;
  const auto visit = [&](std::uint32_t solid) {
    const BodyId body = solids_[solid].body;
    if (body < lowest && (!overlaps_solid(solid, before) || deepens_in(solid, before, after))) lowest = body;
    return false;
  };
  find_crossing(after, [&](const FixedEdge& edge) { return visit(edge.solid); });
  find_swallowing(after, visit);
  return lowest;
}

const ObstacleShape& StaticScene::pieces_of(std::size_t solid) const {
  Pieces& pieces = pieces_[solid];
  std::call_once(pieces.made, [&] {
    try {
      pieces.shape = make_obstacle_shape(convex_pieces(solids_[solid].solid));
    } catch (const std::length_error&) {  // the shape stays empty
    }
  });
  return pieces.shape;
}

bool StaticScene::blocked(const ObstacleShape& shape, const Pose& pose) const {
  return has_obstacles_ && !shape.empty() && overlaps(PlacedShape(shape, pose));
}

std::vector<BodyId> StaticScene::overlapping(const ObstacleShape& shape, const Pose& pose) const {
  std::vector<BodyId> bodies;
  const PlacedShape placed(shape, pose);
  find_crossing(placed, [&](const FixedEdge& edge) {
    bodies.push_back(solids_[edge.solid].body);
    return false;
  });
  find_swallowing(placed, [&](std::uint32_t solid) {
    bodies.push_back(solids_[solid].body);
    return false;
  });
  sort_unique(bodies);
  return bodies;
}

}  // namespace troupe::partition
