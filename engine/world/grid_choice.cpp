#include "engine/world/grid_choice.hpp"

#include "partition/body_index.hpp"
#include "partition/placed_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace troupe::engine {
namespace {

// A given width of tiles must not make cells so wide that each query visits most bodies, nor give each body a
// tile with far more cells than bodies: each cell of a tile in use takes four bytes, and each tick visits it.
constexpr double k_most_coarsening = 8;        // given tiles may widen the cells by this factor
constexpr unsigned k_most_tile_bits = 8;       // a tile is at most 2^8 cells wide
constexpr double k_most_cells = 1 << 22;       // in all tiles in use, or k_most_cells_per_body
constexpr double k_most_cells_per_body = 256;  // as with tiles of the default width, one for each body
constexpr unsigned k_default_tile_bits = 4;

constexpr double k_least_cell_m = 0.05;

// Cells that are wider than the reach of the sensors requires, by up to this factor, cost little time. If
// they would be even wider, a few wide bodies do not count: bodies that have at most this many entries in the
// spatial index per body of the world, and at most this many huge bodies, each of which every query visits.
constexpr double k_much_wider = 6;
constexpr double k_most_wide_entries = 1;
constexpr double k_most_huge = 16;

// Longest reach that counts for the width of the cells, m. A device may have an infinite reach.
constexpr double k_most_hint = 10'000;

// Bodies in a block of cells share the search for their neighbours, but this search also finds more bodies
// that are out of reach. With so many bodies with sensors in a block, or so many bodies in all, a tick takes
// least time. In worlds of few bodies the cells are therefore wider than their reach requires, by at most
// this factor, because bodies may gather later.
constexpr double k_sensing_per_block = 7;
constexpr double k_bodies_per_block = 21;
constexpr double k_most_widening = 3;

/// The ground on which bodies can be expected: the bounds of the world or, if it has none, the smallest box
/// around the static solids and the bodies at their places at the start, m, world frame.
Box expected_ground(const WorldSpec& spec, std::span<const BodyType> types, std::span<const Vec2> places) {
  if (spec.bounds) return *spec.bounds;
  Box ground;
  for (const Vec2& place : places) ground.extend(place);
  for (const BodySpec& body : spec.bodies) {
    if (types[body.type.index()].runs()) continue;
    for (const PartSpec& part : spec.types[body.type.index()].parts)
      for (const Solid& solid : part.solids)
        for (const Ring& contour : placed(solid, body.pose_world_body).contours)
          ground.extend(bounds(contour));
  }
  return ground;
}

/// Estimates how many bodies there are per square metre around a body. Bodies often start close together and
/// then spread, so the result is the geometric mean of two densities: that around a body at the start,
/// averaged over the bodies, and that of the bodies spread evenly over the ground.
///
/// places  positions of the bodies at the start, m, world frame; if there are none, the result is 0
/// ground  size of the ground, m
/// near_m  width of the squares in which bodies at the start are counted, m
double expected_density(std::span<const Vec2> places, const Vec2& ground, double near_m) {
  if (places.empty()) return 0;
  const partition::GridGeometry squares{near_m, 0};
  std::vector<std::pair<std::int32_t, std::int32_t>> of_places;
  of_places.reserve(places.size());
  for (const Vec2& place : places) {
    const partition::Cell square = squares.cell(place);
    of_places.emplace_back(square.x, square.y);
  }
  std::ranges::sort(of_places);
  double near = 0;  // for each body, the number of bodies in its square, added up
  for (std::size_t i = 0; i < of_places.size();) {
    std::size_t end = i;
    while (end < of_places.size() && of_places[end] == of_places[i]) ++end;
    near += static_cast<double>((end - i) * (end - i));
    i = end;
  }
  const auto count = static_cast<double>(places.size());
  const double at_start = near / count / (near_m * near_m);
  const double spread = count / ((ground.x() + near_m) * (ground.y() + near_m));
  return std::sqrt(at_start * spread);
}

/// The width of the bodies of a type (the diameter of their enclosing circle, m) and their number.
struct BodyWidth {
  double width = 0;
  double bodies = 0;
};

/// Whether the spatial index can list these bodies, which are wider than its cells (m), in little time.
bool are_few(std::span<const BodyWidth> types, double cell_m, double bodies_of_the_world) {
  double entries = 0;
  double huge = 0;
  for (const BodyWidth& type : types) {
    entries += type.bodies * partition::BodyIndex::most_entries(0.5 * type.width, cell_m);
    if (partition::BodyIndex::is_huge(0.5 * type.width, cell_m)) huge += type.bodies;
  }
  return entries <= k_most_wide_entries * bodies_of_the_world && huge <= k_most_huge;
}

/// Returns the least width of cells for these bodies, m: their mean width, weighted by width, so that few
/// bodies are listed in several cells, and an eighth of the largest width, so that no body is listed in more
/// than about a hundred cells. If this is much more than `wanted`, the widest bodies are left out, provided
/// that they are few: one truck must not make the cells so wide that each query of a hundred thousand small
/// robots visits a crowd.
double least_cell(std::vector<BodyWidth> types, double wanted) {
  std::erase_if(types, [](const BodyWidth& type) { return type.bodies == 0; });
  std::ranges::sort(types, std::greater(), &BodyWidth::width);
  std::vector<double> least(types.size() + 1, k_least_cell_m);  // [n]: without the n widest types
  double bodies = 0;
  double sum = 0;
  double sum2 = 0;
  for (std::size_t t = types.size(); t-- > 0;) {
    const auto& [width, count] = types[t];
    bodies += count;
    sum += count * width;
    sum2 += count * width * width;
    // The factor covers the rounding of the sums: if all bodies have the same width, no body is wider than a
    // cell.
    const double mean = sum > 0 ? (1 + 1e-9) * sum2 / sum : 0;
    least[t] = std::max({k_least_cell_m, mean, width / 8});
  }
  const std::span<const BodyWidth> all(types);
  std::size_t left_out = 0;
  while (left_out + 1 < all.size() && least[left_out] > k_much_wider * wanted &&
         are_few(all.first(left_out + 1), std::max(least[left_out + 1], wanted), bodies))
    ++left_out;
  return least[left_out];
}

}  // namespace

partition::GridGeometry choose_grid(const WorldSpec& spec, std::span<const BodyType> types,
                                    double tile_size_m) {
  std::vector<Vec2> places;   // of the bodies at the start
  std::vector<Vec2> sensing;  // of those of them that have active sensors
  double sum = 0;
  std::vector<BodyWidth> widths(types.size());
  double count = 0;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const BodySpec& body = spec.bodies[b];
    const BodyType& type = types[body.type.index()];
    if (!type.runs()) continue;
    double reach = 0;
    for (const BodyType::Device& sensor : type.devices)
      if (sensor.active)
        reach = std::max(
            reach, std::min(sensor.prepared.cell_hint_m.value_or(sensor.prepared.reach_m), k_most_hint));
    if (spec.starts(BodyId(b))) {
      places.push_back(body.pose_world_body.position());
      if (reach > 0) sensing.push_back(places.back());
    }
    const double radius = type.radius + type.joint_reach;
    sum += reach > 0 ? 1.001 * (reach + radius) : 16 * radius;
    widths[body.type.index()].width = 2 * radius;
    widths[body.type.index()].bodies += 1;
    ++count;
  }
  const double wanted = count > 0 ? sum / (8 * count) : 1.0;
  const double least = least_cell(std::move(widths), wanted);
  const double narrow = std::max(least, wanted);
  double widening = 1;
  if (!places.empty()) {
    const Vec2 ground = expected_ground(spec, types, places).size();
    const double crowd = std::max(expected_density(sensing, ground, 8 * narrow) / k_sensing_per_block,
                                  expected_density(places, ground, 8 * narrow) / k_bodies_per_block);
    widening = std::clamp(1 / (4 * narrow * std::sqrt(crowd)), 1.0, k_most_widening);
  }
  const double cell = widening * narrow;
  if (!(tile_size_m > 0)) return {cell, k_default_tile_bits};
  const double tile = std::min(tile_size_m, k_most_coarsening * (1u << k_most_tile_bits) * cell);
  const Vec2 ground = spec.bounds.value_or(Box::around(Vec2::Zero(), k_world_reach_m)).size() / tile;
  const double tiles = std::min(count, (ground.x() + 2) * (ground.y() + 2));
  const double most_cells = std::max(k_most_cells, k_most_cells_per_body * count);
  unsigned bits = 0;
  while (bits < k_most_tile_bits && tile / (1u << bits) > cell && tile / (2u << bits) >= least &&
         tiles * static_cast<double>(4u << (2 * bits)) <= most_cells)
    ++bits;
  return {std::max(least, tile / (1u << bits)), bits};
}

}  // namespace troupe::engine
