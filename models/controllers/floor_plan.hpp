#pragma once

#include "base/geometry.hpp"
#include "engine/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::models {

/// A floor plan as a square raster. A cell is blocked if something solid reaches into it.
class FloorPlan {
 public:
  static constexpr int k_cells = 32;  ///< along each side, as in Stage's fasr2

  /// A plan over this box with all cells free.
  explicit FloorPlan(const Box& box) : box_(box), blocked_(k_cells * k_cells, 0) {}
  /// The raster of a body over its bounding box, in the world frame.
  static FloorPlan of_body(const engine::WorldSpec& world, BodyId body);
  /// The raster of the model of this name; if there is none, of the first model outlined by an image; if
  /// there is none either, a free square of 16 m around the origin.
  static FloorPlan of_world(const engine::WorldSpec& world, std::string_view name);

  /// Index of the cell that contains a point, row by row from the bottom, x first. Points outside get the
  /// nearest cell at the border.
  int cell(const Vec2& point) const;
  Vec2 center(int cell) const;  ///< of a cell, m, world frame
  /// Whether a cell is blocked.
  bool blocked(int cell) const { return blocked_[static_cast<std::size_t>(cell)] != 0; }
  /// Marks a cell as blocked.
  void block(int cell) { blocked_[static_cast<std::size_t>(cell)] = 1; }
  int size() const { return static_cast<int>(blocked_.size()); }  ///< number of cells: k_cells squared

 private:
  Box box_;
  std::vector<std::uint8_t> blocked_;
};

inline constexpr int k_free_cost = 1;     ///< of find_way(): a step to a free cell
inline constexpr int k_blocked_cost = 9;  ///< of find_way(): a step to a blocked one
/// The cheapest path from a cell to any of the goals, both ends included, by A* with the Manhattan distance
/// as the heuristic. A step east, north, west or south costs k_free_cost, into a blocked cell k_blocked_cost.
/// Which of several equally cheap paths it returns depends only on the plan. Empty without goals.
std::vector<int> find_way(const FloorPlan& plan, int from, std::span<const int> goals);

/// The cheapest paths from every cell to the nearest of some goals, found when the world is built. So a
/// lookup in a step allocates nothing, and all robots share one constant table.
class WaysTo {
 public:
  /// goals: cells. Without any, next() returns its argument.
  WaysTo(const FloorPlan& plan, std::span<const int> goals);
  /// The cell to go to next; at a goal, the cell itself.
  int next(int cell) const { return next_[static_cast<std::size_t>(cell)]; }
  /// Centre of the cell `steps` steps ahead on the path from a point, m, world frame.
  Vec2 ahead(const Vec2& from, int steps) const;

 private:
  FloorPlan plan_;
  std::vector<std::int16_t> next_;
};

/// The body with this name or generated name; invalid if there is none.
BodyId find_body(const engine::WorldSpec& world, std::string_view name);

}  // namespace troupe::models
