#include "models/controllers/floor_plan.hpp"

#include "partition/placed_shape.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <queue>
#include <tuple>

namespace troupe::models {
namespace {

constexpr int k_cells = FloorPlan::k_cells;

int column(int cell) { return cell % k_cells; }
int row(int cell) { return cell / k_cells; }

/// Lower bound on the cost of a path from a cell to a goal: the Manhattan distance to the nearest goal, which
/// is the cost if no cell is blocked.
int least_left(int from, std::span<const int> goals) {
  int least = 4 * k_cells;
  for (const int goal : goals)
    least = std::min(least, std::abs(column(from) - column(goal)) + std::abs(row(from) - row(goal)));
  return least;
}

/// Calls visit(cell) for each of the four neighbours of a cell, in a fixed order.
template <class Visit>
void for_each_beside(int cell, Visit&& visit) {
  if (column(cell) + 1 < k_cells) visit(cell + 1);
  if (row(cell) + 1 < k_cells) visit(cell + k_cells);
  if (column(cell) > 0) visit(cell - 1);
  if (row(cell) > 0) visit(cell - k_cells);
}

}  // namespace

FloorPlan FloorPlan::of_body(const engine::WorldSpec& world, BodyId body) {
  const engine::BodySpec& spec = world.bodies[body.index()];
  std::vector<ConvexPrism> pieces;
  Box box;
  for (const engine::PartSpec& part : world.types[spec.type.index()].parts)
    for (const Solid& solid : part.solids)
      for (ConvexPrism& piece : convex_pieces(placed(solid, spec.pose_world_body))) {
        box.extend(bounds(piece.outline));
        pieces.push_back(std::move(piece));
      }
  if (box.empty()) box = Box::around(spec.pose_world_body.position(), 0.5);
  FloorPlan plan(box);
  const Vec2 half = 0.5 * box.size() / k_cells;
  for (const ConvexPrism& piece : pieces) {
    const Box reach = bounds(piece.outline);
    const int first = plan.cell(reach.min);
    const int last = plan.cell(reach.max);
    for (int r = row(first); r <= row(last); ++r)
      for (int c = column(first); c <= column(last); ++c) {
        const int cell = r * k_cells + c;
        const Vec2 m = plan.center(cell);
        const std::array<Vec2, 4> square{Vec2(m - half), Vec2(m.x() + half.x(), m.y() - half.y()),
                                         Vec2(m + half), Vec2(m.x() - half.x(), m.y() + half.y())};
        if (!plan.blocked(cell) && partition::convex_overlap(square, piece.outline)) plan.block(cell);
      }
  }
  return plan;
}

FloorPlan FloorPlan::of_world(const engine::WorldSpec& world, std::string_view name) {
  if (const BodyId body = find_body(world, name); body.valid()) return of_body(world, body);
  const auto is_plan = [&world](const engine::BodySpec& body) {
    return world.types[body.type.index()].parts.front().floor_plan;
  };
  const auto first = std::ranges::find_if(world.bodies, is_plan);
  if (first != world.bodies.end())
    return of_body(world, BodyId(static_cast<std::size_t>(first - world.bodies.begin())));
  return FloorPlan(Box::around(Vec2::Zero(), 8));
}

int FloorPlan::cell(const Vec2& point) const {
  const auto index = [&](int axis) {
    const double at = (point[axis] - box_.min[axis]) / box_.size()[axis] * k_cells;
    if (!(at > 0)) return 0;  // also if it is NaN
    return static_cast<int>(std::min(at, k_cells - 1.0));
  };
  return index(1) * k_cells + index(0);
}

Vec2 FloorPlan::center(int cell) const {
  const Vec2 edge = box_.size() / k_cells;
  return {box_.min.x() + (column(cell) + 0.5) * edge.x(), box_.min.y() + (row(cell) + 0.5) * edge.y()};
}

std::vector<int> find_way(const FloorPlan& plan, int from, std::span<const int> goals) {
  if (goals.empty()) return {};
  constexpr int k_unknown = -1;
  const auto cells = static_cast<std::size_t>(plan.size());
  std::vector<int> cost(cells, k_unknown);
  std::vector<int> before(cells, k_unknown);
  // The queue yields the cell with the least total cost first. Of several such cells, it yields the one with
  // the least remaining cost, then the one with the lowest index.
  using Open = std::tuple<int, int, int>;  // bounds on the total and the remaining cost of a path; its cell
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  cost[static_cast<std::size_t>(from)] = 0;
  open.emplace(least_left(from, goals), least_left(from, goals), from);
  while (!open.empty()) {
    const auto [in_all, left, cell] = open.top();
    open.pop();
    const int so_far = cost[static_cast<std::size_t>(cell)];
    if (so_far + left != in_all) continue;  // a cheaper path to this cell was found since
    if (std::ranges::find(goals, cell) != goals.end()) {
      std::vector<int> way{cell};
      while (way.back() != from) way.push_back(before[static_cast<std::size_t>(way.back())]);
      std::ranges::reverse(way);
      return way;
    }
    for_each_beside(cell, [&, c = cell](int beside) {
      const auto at = static_cast<std::size_t>(beside);
      const int there = so_far + (plan.blocked(beside) ? k_blocked_cost : k_free_cost);
      if (cost[at] != k_unknown && cost[at] <= there) return;
      cost[at] = there;
      before[at] = c;
      const int rest = least_left(beside, goals);
      open.emplace(there + rest, rest, beside);
    });
  }
  return {};  // not reached: there is a path between any two cells
}

WaysTo::WaysTo(const FloorPlan& plan, std::span<const int> goals)
    : plan_(plan), next_(static_cast<std::size_t>(plan.size()), std::int16_t{-1}) {
  for (int cell = 0; cell < plan.size(); ++cell) {
    if (next(cell) >= 0) continue;
    // From each cell of a cheapest path, the rest of the path is a cheapest path too. So the other cells of
    // the path need no search of their own.
    const std::vector<int> way = find_way(plan, cell, goals);
    if (way.empty()) next_[static_cast<std::size_t>(cell)] = static_cast<std::int16_t>(cell);
    for (std::size_t i = 0; i < way.size(); ++i) {
      std::int16_t& next = next_[static_cast<std::size_t>(way[i])];
      if (next >= 0) break;  // the rest of the path is known
      next = static_cast<std::int16_t>(way[std::min(i + 1, way.size() - 1)]);
    }
  }
}

Vec2 WaysTo::ahead(const Vec2& from, int steps) const {
  int cell = plan_.cell(from);
  for (int i = 0; i < steps; ++i) cell = next(cell);
  return plan_.center(cell);
}

BodyId find_body(const engine::WorldSpec& world, std::string_view name) {
  const std::optional<engine::Name> wanted = world.names.find(name);
  BodyId found;
  if (!wanted) return found;
  for (const engine::NamedBody& alias : world.aliases)
    if (alias.name == *wanted) found = alias.body;
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    if (world.bodies[b].name == *wanted) found = BodyId(b);
  return found;
}

}  // namespace troupe::models
