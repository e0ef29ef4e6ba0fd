#pragma once

#include "base/diagnostics.hpp"
#include "base/ids.hpp"
#include "base/pose.hpp"
#include "engine/conflicts/movement.hpp"
#include "engine/links/links.hpp"
#include "engine/rows/placed_rows.hpp"
#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"
#include "partition/placed_shape.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace troupe::engine {

/// Throws std::invalid_argument if the body cannot be placed at this pose: if a number is not finite, or if
/// the position is outside the bounds of the world.
void require_place(const WorldState& state, BodyId body, const Pose& pose);

/// Where the bodies of a world are: keeps the derived data about their places, places bodies at other poses,
/// and tests whether a place is free.
class Places {
 public:
  /// The arguments must outlive the object.
  Places(WorldState& state, partition::Parallel& parallel, Links& links, Movement& movement)
      : state_(state), parallel_(parallel), links_(links), movement_(movement) {}
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

  // ---- Derived data
  /// Computes the data of a row that follow from its state: shape, radius, outlines, joints.
  void derive(Row row);
  /// Rebuilds the spatial index and, if the world has one, redraws the ray grid.
  void index();
  /// Makes the ray grid, with the static scene. redraw_ray_grid() must follow. Throws InputError if the grid
  /// cannot represent the scene.
  void build_ray_grid(Diagnostics& diagnostics);
  void redraw_ray_grid();  ///< draws all bodies into the ray grid, which must exist
  /// For tests: overwrites the derived data of this class with junk.
  void forget();

  // ---- Bodies that are placed
  /// Reserves memory, so that placing bodies allocates none later.
  void reserve_placed();
  /// Places a body that is not carried at a pose (world frame). carry_placed(), Movement::count_stalls() and
  /// index() must follow; one call of each is enough for several bodies.
  void place(Row row, const Pose& pose);
  /// Called after place(): moves all carried bodies with their carriers.
  void carry_placed();
  /// Called when a step begins: from now on, placed_before_step() lists the bodies placed since the last
  /// step.
  void begin_step();
  void clear_placed();  ///< no body was placed, in this step or before
  /// The bodies that were placed between the last two steps, or in the phase intervene of the last step, with
  /// their poses before the motions of the last step. All bodies that were carried when this happened are
  /// listed too. Each row occurs once. Empty before the first step. Not a part of the state.
  std::span<const Placed> placed_before_step() const { return placed_before_.all(); }
  /// The lists of the bodies placed since the last step and before it, for code that gives bodies other rows.
  std::array<PlacedRows*, 2> placed_lists() { return {&placed_, &placed_before_}; }

  // ---- Free places
  /// A body that was born since the index was built, which therefore does not contain it.
  struct Newborn {
    BodyId body;  ///< the body, whose row may be on another rank
    Pose pose;    ///< at birth, world frame
  };
  /// Whether the origin of the body `id` would be within the bounds at a pose, and the body, with this shape,
  /// would overlap neither the static scene nor another body that is an obstacle. With an empty shape, only
  /// the bounds count. The pose must be finite.
  bool is_free(BodyId id, const partition::ObstacleShape& shape, const Pose& pose) const;
  /// The bodies that the index does not contain yet. index() and index_newborn() clear the list. It is the
  /// same on all ranks: the rows may be elsewhere.
  std::vector<Newborn>& newborn() { return newborn_; }
  /// Whether so many bodies were born since the index was built that it should be rebuilt: each birth is
  /// tested one by one against these bodies. The sum of the times for these tests and for rebuilding the
  /// index is lowest if their number is near the square root of the number of bodies.
  bool has_many_newborn() const;
  /// Adds the bodies of newborn() to the index. Their rows must be here.
  void index_newborn();

 private:
  void remember_placed(Row row) { placed_.set(row, state_.poses()[row.index()]); }

  WorldState& state_;
  partition::Parallel& parallel_;
  Links& links_;
  Movement& movement_;

  std::vector<Newborn> newborn_;
  std::vector<double> grid_lifts_;  // height offset of each outline that the grid ray engine draws, m
  PlacedRows placed_;               // set since the last step
  PlacedRows placed_before_;        // set between the last two steps
};

}  // namespace troupe::engine
