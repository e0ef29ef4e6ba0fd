#include "engine/rows/places.hpp"

#include "engine/kinds/finite.hpp"
#include "engine/rows/starting.hpp"
#include "partition/ranging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>

namespace troupe::engine {

void require_place(const WorldState& state, BodyId body, const Pose& pose) {
  const Box inside = state.bounds();
  if (!is_finite(pose) || !inside.contains(pose.position()))
    throw std::invalid_argument(
        fmt::format("\"{}\" cannot be placed at x {}, y {}, z {} (m), heading {} (rad): {}",
                    state.spec.name(body), pose.x, pose.y, pose.z, pose.heading,
                    is_finite(pose) ? outside_text(inside) : "the numbers must be finite"));
}

void Places::derive(Row row) {
  movement_.rest(row);
  state_.update_presence(row);
  if (links_.any()) {
    links_.rest_joints(row);
    links_.reshape(row.value);
  }
  state_.update_outlines(row, state_.type(row), Transform(state_.poses()[row.index()]));
}

void Places::index() {
  state_.index.rebuild(state_.transforms, state_.radii, parallel_);
  newborn_.clear();
  if (state_.ray_grid) redraw_ray_grid();
}

void Places::build_ray_grid(Diagnostics& diagnostics) {
  std::vector<partition::MovingOutline> outlines;
  for (std::uint32_t r = 0; r < state_.row_count(); ++r)
    for (const RayOutline& outline : state_.type(Row(r)).outlines)
      outlines.push_back({r, static_cast<std::uint32_t>(state_.outline_begins[r]) + outline.first,
                          outline.count, outline.z, outline.ranger_return});
  if (links_.any()) grid_lifts_.resize(outlines.size());
  if (const double edge_m = state_.spec.resolution_m;
      !(k_min_resolution_m <= edge_m && edge_m <= k_max_resolution_m)) {
    diagnostics.error(state_.spec.resolution_where,
                      fmt::format("\"resolution\" must be from {} to {} m for the grid ray engine, found {}",
                                  k_min_resolution_m, k_max_resolution_m, edge_m));
    diagnostics.throw_if_errors();
  }
  try {
    state_.ray_grid = std::make_unique<partition::RayGrid>(state_.scene.solids(), std::move(outlines),
                                                           state_.outlines, state_.spec.resolution_m);
  } catch (const std::length_error& error) {
    diagnostics.error(state_.spec.resolution_where, fmt::format("the grid ray engine: {}", error.what()));
    diagnostics.throw_if_errors();
  }
  state_.bind_view();
}

void Places::redraw_ray_grid() {
  std::size_t o = 0;
  for (std::uint32_t r = 0; !grid_lifts_.empty() && r < state_.row_count(); ++r)
    for (const RayOutline& outline : state_.type(Row(r)).outlines)
      if (outline.count > 0) grid_lifts_[o++] = state_.view.lift(Row(r), outline.joint);
  partition::RayGrid::Linked linked{.lifts = grid_lifts_, .groups = {}, .absent = {}};
  if (state_.now.carried > 0) linked.groups = state_.roots;
  if (state_.now.absent > 0) linked.absent = state_.not_drawn;
  state_.ray_grid->redraw(state_.outlines, state_.poses(), parallel_, linked);
}

void Places::forget() {
  std::ranges::fill(state_.transforms, Transform{{k_nan, k_nan}, Rotation(SinCos{k_nan, k_nan})});
  std::fill_n(state_.outlines.begin(), state_.outlines.size() - partition::EdgeBlock::k_piece,
              Vec2(k_nan, k_nan));
  std::ranges::fill(state_.radii, k_nan);
  std::ranges::fill(state_.shapes, nullptr);
  std::ranges::fill(state_.not_drawn, std::uint8_t{0x5a});
  std::ranges::fill(grid_lifts_, k_nan);
  state_.index = partition::BodyIndex(state_.geometry);
  placed_before_.set(Row(0), k_nowhere);
}

void Places::reserve_placed() {
  for (PlacedRows* list : placed_lists()) list->reserve(state_.row_count());
}

void Places::place(Row row, const Pose& pose) {
  const Pose placed = canonical(pose);
  state_.poses()[row.index()] = placed;
  state_.stalls()[row.index()] = static_cast<std::uint8_t>(Stall::free);
  if (state_.has_contacts()) state_.contact(row) = {};
  movement_.rest(row);
  state_.update_outlines(row, state_.type(row), Transform(placed));
  remember_placed(row);
}

void Places::carry_placed() {
  if (state_.now.carried == 0) return;
  links_.carry();
  for (std::size_t r = 0; r < state_.row_count(); ++r)
    if (state_.view.carrier(Row(r))) remember_placed(Row(r));
}

void Places::begin_step() {
  placed_before_.swap(placed_);
  placed_.clear();
}

void Places::clear_placed() {
  placed_.clear();
  placed_before_.clear();
}

bool Places::is_free(BodyId id, const partition::ObstacleShape& shape, const Pose& pose) const {
  if (!state_.bounds().contains(pose.position())) return false;
  if (shape.empty()) return true;
  if (state_.scene.has_obstacles() && state_.scene.blocked(shape, pose)) return false;
  bool free = true;
  const auto look_at = [&](BodyId other, const partition::ObstacleShape& its_shape, const Pose& its_pose) {
    if (!free || other == id || its_shape.empty()) return;
    // The body with the lower id is the first argument, as in conflict resolution: the order of the arguments
    // could change the result by rounding, and both tests must agree.
    free =
        id < other ? !overlap(shape, pose, its_shape, its_pose) : !overlap(its_shape, its_pose, shape, pose);
  };
  const auto look_at_row = [&](std::uint32_t r) {
    look_at(state_.bodies[r], *state_.shapes[r], state_.poses()[r]);
  };
  state_.index.for_each_near(Box::around(pose.position(), shape.radius),
                             [&](const partition::BodyCircle& other) { look_at_row(other.row); });
  for (const Newborn& other : newborn_) {
    if (state_.view.location(other.body) == RowLocation::here)
      look_at_row(state_.view.row(other.body).value);
    else  // its row is on another rank until the ranks distribute the rows
      look_at(other.body, state_.type(other.body).obstacle, other.pose);
  }
  return free;
}

bool Places::has_many_newborn() const {
  const double bodies = static_cast<double>(state_.rows.size());
  return static_cast<double>(newborn_.size()) >= std::max(64.0, 2 * std::sqrt(bodies));
}

void Places::index_newborn() {
  state_.index.rebuild(state_.transforms, state_.radii, parallel_);
  newborn_.clear();
}

}  // namespace troupe::engine
