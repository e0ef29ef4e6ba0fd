#pragma once

#include "base/geometry.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::models {

/// A raster of k_cells x k_cells cells over a rectangle, the box of the plan. Each cell is free or blocked;
/// cells that a wall reaches are blocked. The index of the cell in column c (along x) and row r (along y) is
/// r * k_cells + c; column 0 has the least x, row 0 the least y.
class FloorPlan {
 public:
  static constexpr int k_cells = 32;  ///< number of cells along each side, as in Stage's fasr2

  /// Makes a plan with all cells free. box: m, world frame; its area must be above 0.
  explicit FloorPlan(const Box& box) : box_(box), blocked_(k_cells * k_cells, 0) {}
  /// Returns the plan of a body at its pose in the world file. The box of the plan is the bounding box of the
  /// body's solids (shapes) in the world frame; the cells that these solids reach are blocked. If the body
  /// has no solids, all cells are free, and the box is a square with edges of 1 m around the body's origin.
  /// Throws std::length_error if a solid is so complex that cutting it into convex pieces would take longer
  /// than a few seconds.
  static FloorPlan of_body(const engine::WorldSpec& world, BodyId body);
  /// Returns the plan of the body with this name (see of_body()). If no body has the name, returns the plan
  /// of the first body that the world file declares to be a floor plan (PartSpec::floor_plan), such as the
  /// walls of a building. If there is no such body either, returns a plan with all cells free, whose box is a
  /// square with edges of 16 m around the origin of the world. Throws std::length_error as of_body() does.
  static FloorPlan of_world(const engine::WorldSpec& world, std::string_view name);

  /// Index of the cell that contains a point (m, world frame). If the point is outside the box: index of the
  /// nearest cell. A coordinate that is NaN counts as that of the lower left corner of the box.
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
/// Returns the cheapest path from the cell `from` to any of the cells `goals`, as a list of cells that begins
/// with `from` and ends with a goal. Empty if `goals` is empty. Cells are given by their indices
/// (FloorPlan::cell()). A step leads to one of the four neighbours of a cell, which may be blocked. It costs
/// k_free_cost, or k_blocked_cost if the neighbour is blocked. Equal arguments give the same path, even if
/// several paths are equally cheap.
std::vector<int> find_way(const FloorPlan& plan, int from, std::span<const int> goals);

/// A table with the cheapest path from every cell of a plan to any of several goals, as find_way() returns
/// it. The constructor computes the whole table, so look-ups are fast and allocate no memory. Controllers
/// make the table when the world is loaded; all robots share it.
class WaysTo {
 public:
  /// goals: indices of cells. If there are no goals, next() returns the cell that it was given.
  WaysTo(const FloorPlan& plan, std::span<const int> goals);
  /// The next cell on the cheapest path from this cell to a goal. If the cell is a goal, the cell itself.
  int next(int cell) const { return next_[static_cast<std::size_t>(cell)]; }
  /// The centre of the cell that is `steps` steps ahead on the cheapest path from the cell of the point
  /// `from` to a goal. If the path has fewer steps, the centre of the goal. `from` and the result are in m,
  /// world frame.
  Vec2 ahead(const Vec2& from, int steps) const;

 private:
  FloorPlan plan_;
  std::vector<std::int16_t> next_;
};

/// Returns the id of the body with this name. Names are those in the world file; bodies without a name there
/// get one when the file is loaded. If several bodies have the name, returns the last of them. If no body has
/// it, returns an id for which valid() is false.
BodyId find_body(const engine::WorldSpec& world, std::string_view name);

}  // namespace troupe::models
