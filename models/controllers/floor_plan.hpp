#pragma once

#include "base/geometry.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::models {

/// A floor plan as a raster of k_cells x k_cells cells over a box. Each cell is free, or blocked by a wall
/// that reaches into it. Cells are numbered along x, row by row, from the row of the least y.
class FloorPlan {
 public:
  static constexpr int k_cells = 32;  ///< number of cells along each side, as in Stage's fasr2

  /// A plan over this box (m, world frame; not empty and with an area above 0) with all cells free.
  explicit FloorPlan(const Box& box) : box_(box), blocked_(k_cells * k_cells, 0) {}
  /// The raster of the solids (shapes) of a body at its pose in the world file, over the bounding box of
  /// these solids in the world frame. For a body without solids, it is a free square with edges of 1 m around
  /// the body's origin. Throws std::length_error if a solid is so complex that cutting it into convex pieces
  /// would take longer than a few seconds.
  static FloorPlan of_body(const engine::WorldSpec& world, BodyId body);
  /// The raster of the body with this name. If no body has this name, returns the raster of the first body
  /// that is a floor plan (PartSpec::floor_plan of its main part), such as the walls of a building. If the
  /// world has no floor plan either, returns a free square with edges of 16 m around the origin of the world.
  /// Throws std::length_error as of_body() does.
  static FloorPlan of_world(const engine::WorldSpec& world, std::string_view name);

  /// Index of the cell that contains a point (m, world frame). For a point outside the box, the index of the
  /// nearest cell.
  int cell(const Vec2& point) const;
  Vec2 center(int cell) const;  ///< centre of a cell, m, world frame
  /// Whether a cell is blocked.
  bool blocked(int cell) const { return blocked_[static_cast<std::size_t>(cell)] != 0; }
  /// Marks a cell as blocked.
  void block(int cell) { blocked_[static_cast<std::size_t>(cell)] = 1; }
  int size() const { return static_cast<int>(blocked_.size()); }  ///< number of cells: k_cells squared

 private:
  Box box_;
  std::vector<std::uint8_t> blocked_;
};

inline constexpr int k_free_cost = 1;     ///< cost in find_way() of a step to a free cell
inline constexpr int k_blocked_cost = 9;  ///< cost in find_way() of a step to a blocked cell
/// The cheapest path from the cell `from` to any of the goals, which are indices of cells
/// (FloorPlan::cell()). The result lists the cells of the path, `from` and the goal included. It is empty if
/// there are no goals. Steps lead east, north, west or south, also into blocked cells. A step costs
/// k_free_cost, or k_blocked_cost if it leads into a blocked cell. The path is found by A* with the Manhattan
/// distance as the heuristic. Which of several equally cheap paths is returned depends only on the arguments.
std::vector<int> find_way(const FloorPlan& plan, int from, std::span<const int> goals);

/// A table of the cheapest path (find_way) from every cell of a plan to any of several goals. The constructor
/// computes the whole table. Controllers make the table when the world is built, so that all robots share it
/// and a lookup during the simulation allocates no memory.
class WaysTo {
 public:
  /// goals: indices of cells. If there are none, next() returns its argument.
  WaysTo(const FloorPlan& plan, std::span<const int> goals);
  /// The next cell on the cheapest path from this cell. At a goal, the goal itself.
  int next(int cell) const { return next_[static_cast<std::size_t>(cell)]; }
  /// Centre of the cell that is `steps` steps ahead on the cheapest path from the point `from`. If the path
  /// has fewer steps, the centre of the goal. `from` and the result are in m, world frame.
  Vec2 ahead(const Vec2& from, int steps) const;

 private:
  FloorPlan plan_;
  std::vector<std::int16_t> next_;
};

/// The body with this name. The name is from the world file, or was generated when the file was loaded. If
/// several bodies have the name, returns the last of them; if no body has the name, returns an id for which
/// valid() is false.
BodyId find_body(const engine::WorldSpec& world, std::string_view name);

}  // namespace troupe::models
