#pragma once

#include "base/geometry.hpp"
#include "engine/world_spec.hpp"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::models {

/// A floor plan as a square raster: which of its cells something solid reaches into.
class FloorPlan {
 public:
  static constexpr int k_cells = 32;  ///< along each side, as in Stage's fasr2

  /// All of its cells free.
  explicit FloorPlan(const Box& box) : box_(box), blocked_(k_cells * k_cells, 0) {}
  /// The raster of a model, over its bounding box, in the world's frame.
  static FloorPlan of_body(const engine::WorldSpec& world, BodyId body);
  /// Of the model of this name; where there is none, of the first that is outlined by an image; where there
  /// is none either, free ground of 16 m about the origin.
  static FloorPlan of_world(const engine::WorldSpec& world, std::string_view name);

  /// The cell below a point: those outside are those at the border. Row by row from below, x first.
  int cell(const Vec2& point) const;
  Vec2 center(int cell) const;  ///< m, world frame
  /// Whether something solid reaches into it.
  bool blocked(int cell) const { return blocked_[static_cast<std::size_t>(cell)] != 0; }
  /// From now on it counts as blocked.
  void block(int cell) { blocked_[static_cast<std::size_t>(cell)] = 1; }
  int size() const { return static_cast<int>(blocked_.size()); }  ///< cells: k_cells squared

 private:
  Box box_;
  std::vector<std::uint8_t> blocked_;
};

inline constexpr int k_free_cost = 1;     ///< of find_way(): a step to a free cell
inline constexpr int k_blocked_cost = 9;  ///< of find_way(): a step to a blocked one
/// The cheapest way from one cell to the nearest of the goals, both included: to the next cell, east, north,
/// west or south, costs k_free_cost, into a blocked one k_blocked_cost. A*, with the Manhattan distance as
/// what is left at least. Of ways that cost the same the one that is found depends on the plan alone. Empty
/// without goals.
std::vector<int> find_way(const FloorPlan& plan, int from, std::span<const int> goals);

/// The ways from every cell to the nearest of some goals, all found beforehand: what a robot looks up while
/// the world runs allocates nothing, is shared by all and never changes.
class WaysTo {
 public:
  /// Goals: cells; without any, next() is the cell itself.
  WaysTo(const FloorPlan& plan, std::span<const int> goals);
  /// The cell to go to next; the cell itself at a goal.
  int next(int cell) const { return next_[static_cast<std::size_t>(cell)]; }
  /// A point to head for: the centre of the cell so many steps ahead.
  Vec2 ahead(const Vec2& from, int steps) const;

 private:
  FloorPlan plan_;
  std::vector<std::int16_t> next_;
};

/// The body of this name or generated name; not valid where there is none.
BodyId find_body(const engine::WorldSpec& world, std::string_view name);

}  // namespace troupe::models
