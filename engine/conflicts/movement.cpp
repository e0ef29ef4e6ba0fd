#include "engine/conflicts/movement.hpp"

#include "base/capacity.hpp"
#include "engine/state/batches.hpp"
#include "partition/placed_shape.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <limits>

namespace troupe::engine {

void Movement::build() {
  resize_with_capacity(motions_, state_.row_count());
  resize_with_capacity(state_.free_circles, state_.row_count());
  if (finds_blocks_) resize_with_capacity(blocks_, state_.row_count());
  turns_.clear();
  if (std::ranges::any_of(
          state_.types, [](const BodyType& type) { return type.drive && type.drive->turns_when_blocked; })) {
    for (std::size_t r = 0; r < state_.row_count(); ++r) {
      const auto& drive = state_.type(Row(r)).drive;
      turns_.push_back(drive && drive->turns_when_blocked);
    }
    change_capacity(turns_, turns_.size());
  }
  if (std::ranges::none_of(state_.types, &BodyType::pushable)) return;
  // The sizes are those of all bodies of the world, and stay when rows go to other ranks.
  const bool is_first = pushables_.thinnest == 0;
  if (is_first) pushables_.thinnest = std::numeric_limits<double>::infinity();
  is_pushable_.clear();
  push_limits_.clear();
  pushables_.most = 0;
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const BodyType& t = state_.type(Row(r));
    const bool is_pushable = t.pushable && !t.obstacle.empty();
    is_pushable_.push_back(is_pushable);
    push_limits_.push_back(t.drive ? t.drive->pushes : 0);
    pushables_.most += push_limits_.back();
    if (!is_first || !is_pushable) continue;
    pushables_.radius = std::max(pushables_.radius, t.obstacle.radius);
    pushables_.thinnest = std::min(pushables_.thinnest, t.obstacle.thinnest);
  }
  change_capacity(is_pushable_, is_pushable_.size());
  change_capacity(push_limits_, push_limits_.size());
  pushables_.is_pushable = is_pushable_;
  pushables_.limits = push_limits_;
}

void Movement::draw_odometry_errors() {
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const auto& drive = state_.type(Row(r)).drive;
    if (!drive || !drive->odometry_table) continue;
    resize_with_capacity(odometry_errors_, state_.row_count());
    odometry_errors_[r] = drive->localization.error_of(state_.spec.seed, state_.bodies[r]);
  }
}

void Movement::rest(Row row) {
  motions_[row.index()] = Motion();
  state_.free_circles[row.index()] = FreeCircle();
}

void Movement::count_stalls() {
  const auto own = state_.stalls().first(state_.own_rows);
  state_.now.out_of_bounds =
      static_cast<std::size_t>(std::ranges::count(own, static_cast<std::uint8_t>(Stall::out_of_bounds)));
  state_.now.stalled = state_.now.out_of_bounds + static_cast<std::size_t>(std::ranges::count(
                                                      own, static_cast<std::uint8_t>(Stall::blocked)));
}

namespace {
const Motion k_junk_motion{k_nowhere, Rotation(SinCos{k_nan, k_nan}), k_nan, true};
}  // namespace

void Movement::forget() {
  std::ranges::fill(odometry_errors_, Localization::Error{k_nan, k_nan, k_nan});
  std::ranges::fill(state_.free_circles, FreeCircle{0, 0, std::numeric_limits<float>::infinity(), false});
  std::ranges::fill(motions_, k_junk_motion);
  std::ranges::fill(blocks_, Conflicts::Block{{~0u, ~0u, ~0u}, ~0u, ~0u, {}, k_nan});
  crowd_ = {};
  conflicts_.forget();
  state_.now.stalled = state_.now.out_of_bounds = 0x5a5a5a5a;
}

void Movement::forget_motions() {
  for (std::size_t r = 0; r < state_.row_count(); ++r)
    if (state_.view.is_there(Row(r))) motions_[r] = k_junk_motion;
}

void Movement::propose() {
  const double dt = state_.spec.tick_s;
  const bool carrying = state_.now.carried > 0;  // carried bodies move with their carriers
  for_blocks(state_, parallel_, [&](std::span<const Row> rows, const BodyType& type) {
    std::array<Motion*, k_row_block> turning;
    std::array<double, k_row_block> headings;
    std::array<SinCos, k_row_block> rotations;
    std::size_t count = 0;
    for (const Row row : rows) {
      const Velocity& v = state_.as<Velocity>(WorldState::k_velocity)[row.index()];
      Motion& motion = motions_[row.index()];
      motion.moves =
          type.drive && (v.x != 0 || v.y != 0 || v.turn != 0) && !(carrying && state_.view.carrier(row));
      if (!motion.moves) continue;
      // Euler integration with the old heading, as in Stage.
      const Pose& from = state_.poses()[row.index()];
      motion.turn = v.turn * dt;
      const Pose to = compose(from, state_.view.transform(row), {v.x * dt, v.y * dt, 0, motion.turn});
      motion.to = {to.x + 0.0, to.y + 0.0, to.z + 0.0, to.heading + 0.0};
      motion.rotation = state_.view.transform(row).rotation;
      if (to.heading == from.heading) continue;
      turning[count] = &motion;
      headings[count++] = motion.to.heading;
    }
    sincos({headings.data(), count}, {rotations.data(), count});
    for (std::size_t i = 0; i < count; ++i) turning[i]->rotation = Rotation(rotations[i]);
  });
}

void Movement::resolve(std::span<const std::uint32_t> composites, Conflicts::Border* border) {
  Pushables pushables = pushables_;  // sizes with joints at rest and without cargo; corrected below
  if (pushables.any())
    for (const std::uint32_t row : composites) {
      // A body that is carried or not in the world has an empty shape, which has no width.
      if (is_pushable_[row] == 0 || state_.shapes[row]->empty()) continue;
      pushables.radius = std::max(pushables.radius, state_.shapes[row]->radius);
      pushables.thinnest = std::min(pushables.thinnest, state_.shapes[row]->thinnest);
    }
  crowd_ = {state_.poses(),  state_.transforms,   motions_,         state_.shapes,
            state_.ids,      state_.free_circles, state_.spec.seed, state_.now.tick,
            state_.bounds(), pushables,           turns_,           blocks_};
  conflicts_.resolve(crowd_, state_.scene, state_.index, parallel_, border);
}

void Movement::commit() {
  std::atomic<std::size_t> stalled = 0;
  std::atomic<std::size_t> out_of_bounds = 0;
  for_blocks(state_, parallel_, [&](std::span<const Row> rows, const BodyType& type) {
    std::size_t blocked_here = 0;
    std::size_t out_of_bounds_here = 0;
    const bool has_odometry = type.drive && type.drive->odometry_table;
    for (const Row row : rows) {
      const Conflicts::Outcome outcome = conflicts_.outcome(row.index());
      if (outcome == Conflicts::Outcome::moved) {
        const Motion& motion = motions_[row.index()];
        state_.poses()[row.index()] = motion.to;
        state_.update_outlines(row, type, motion.there());
        if (has_odometry) count_way(row, *type.drive, 1);
      } else if (outcome == Conflicts::Outcome::turned) {
        const Motion& motion = motions_[row.index()];
        state_.poses()[row.index()].heading = motion.to.heading;
        state_.update_outlines(row, type, Transform{state_.view.transform(row).position, motion.rotation});
        if (has_odometry) count_way(row, *type.drive, 0);
      }
      const bool is_blocked = outcome == Conflicts::Outcome::blocked || outcome == Conflicts::Outcome::turned;
      const bool is_out_of_bounds = outcome == Conflicts::Outcome::out_of_bounds;
      state_.stalls()[row.index()] = static_cast<std::uint8_t>(is_blocked         ? Stall::blocked
                                                               : is_out_of_bounds ? Stall::out_of_bounds
                                                                                  : Stall::free);
      const bool is_own = row.index() < state_.own_rows;
      if (state_.has_contacts()) state_.contact(row) = is_own ? blocks_[row.index()].contact : Contact();
      if (!is_own) continue;
      blocked_here += is_blocked;
      out_of_bounds_here += is_out_of_bounds;
    }
    stalled.fetch_add(blocked_here + out_of_bounds_here, std::memory_order_relaxed);
    out_of_bounds.fetch_add(out_of_bounds_here, std::memory_order_relaxed);
  });
  state_.now.stalled = stalled;
  state_.now.out_of_bounds = out_of_bounds;
  if (pushables_.any()) commit_pushes();
}

void Movement::commit_pushes() {
  const std::span<const Conflicts::Push> pushes = conflicts_.pushes();
  parallel_.for_batches(pushes.size(), k_row_block, [&](std::size_t first, std::size_t end) {
    for (const Conflicts::Push& push : pushes.subspan(first, end - first)) {
      if (!conflicts_.is_last(push)) continue;
      const Row row(push.row);
      Pose& pose = state_.poses()[push.row];
      pose.x = push.position.x();
      pose.y = push.position.y();
      state_.update_outlines(row, state_.type(row),
                             Transform{push.position, state_.view.transform(row).rotation});
    }
  });
}

void Movement::count_way(Row row, const BodyType::Drive& drive, double share) {
  const Velocity& v = state_.as<Velocity>(WorldState::k_velocity)[row.index()];
  const double dt = state_.spec.tick_s;
  state_.as<Odometry>(*drive.odometry_table)[state_.slots[row.index()]].advance(
      drive.localization, odometry_errors_[row.index()], share * v.x * dt, share * v.y * dt, v.turn * dt);
}

}  // namespace troupe::engine
