#include "engine/world/world.hpp"

#include "base/exact_sum.hpp"
#include "base/fp_environment.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/world/kind_errors.hpp"
#include "partition/placed_shape.hpp"
#include "partition/ranging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe::engine {
namespace {

const Localization k_true_pose;  // the localization of bodies without a drive

}  // namespace

void World::start() {
  const Completion completion(*this);
  state_.now.tick = 0;
  beams_ = conflict_rounds_ = 0;
  derive_experiment();  // first, because bodies start with the parameters of tick 0
  for (StateTable& table : state_.tables) table.clear();
  for (std::size_t r = 0; r < rows(); ++r) {
    const BodyId body = state_.bodies[r];
    if (state_.spec.starts(body))
      start(Row(r), state_.spec.bodies[body.index()].pose_world_body);
    else
      state_.life(Row(r)).presence = static_cast<std::uint8_t>(Presence::unborn);
  }
  derive();
}

/// Returns `p` with its heading wrapped and -0 replaced by 0, so that equal poses have equal bits.
Pose World::at_start(const Pose& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0, wrap_angle(p.heading) + 0.0}; }

void World::start(Row row, const Pose& p) {
  const BodyType& type = this->type(row);
  for (const BodyType::Device& device : type.devices)
    if (device.kind->start)
      call_kind(*this, {&row, 1}, device,
                [&] { device.kind->start(device.prepared.data, state_.tables[device.table], slot(row)); });
  for (const std::size_t d : type.joint_devices) {
    const BodyType::Device& device = type.devices[d];
    const std::vector<Pose>& joints = device.prepared.joints;
    for (std::size_t n = 0; n < joints.size(); ++n)
      state_.tables[type.joints[static_cast<std::size_t>(device.moves) + n].table].as<Pose>(slot(row)) =
          joints[n];
  }
  for (const BodyType::Controller& controller : type.controllers)
    if (controller.table)
      call_kind(*this, {&row, 1}, controller,
                [&] { controller.kind->start(state_.tables[*controller.table].row(slot(row))); });
  state_.poses()[row.index()] = at_start(p);
  if (type.drive) start(row, *type.drive);
}

void World::start(Row row, const BodyType::Drive& drive) {
  if (drive.kind->start) {
    const Velocity v = call_kind(*this, {&row, 1}, drive, [&] { return drive.kind->start(drive.data); });
    if (!is_finite(v))
      throw StepError(
          fmt::format("tick {}: drive \"{}\" of \"{}\" starts with the velocity x {}, y {} (m/s), turn "
                      "{} (rad/s) (DriveKind::start): the numbers must be finite",
                      tick(), drive.kind->name, state_.spec.name(body(row)), v.x, v.y, v.turn),
          body(row));
    state_.as<Velocity>(WorldState::k_velocity)[row.index()] = v;
  }
  if (!drive.odometry_table) return;
  const Pose& pose = poses()[row.index()];
  const Pose estimate = relative_to(drive.localization.origin.value_or(pose), pose);
  state_.as<Odometry>(*drive.odometry_table)[slot(row)] = {estimate.x, estimate.y, estimate.heading};
}

void World::derive() {
  movement_.draw_odometry_errors();
  derive_experiment();
  derive_state();
}

void World::derive_state() {
  std::ranges::fill(state_.contacts, Contact());
  derive_lives();
  count_impaired();
  movement_.count_stalls();
  links_.derive();
  for (std::size_t r = 0; r < rows(); ++r) derive(Row(r));
  effects_.clear();
  begin_placing();
  placed_before_.clear();
  index_bodies();
}

double World::farthest_in_trees() const {
  double farthest = 0;
  if (state_.now.carried == 0) return farthest;
  for (std::uint32_t r = 0; r < rows(); ++r)
    if (state_.roots[r] == r && links_.first_cargo(Row(r)) != Links::k_none)
      farthest = std::max(farthest, links_.farthest(Row(r)));
  return farthest;
}

void World::derive(Row row) {
  movement_.rest(row);
  state_.update_presence(row);
  if (links_.any()) {
    links_.rest_joints(row);
    links_.reshape(row.value);
  }
  state_.update_outlines(row, type(row), Transform(poses()[row.index()]));
}

void World::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  std::ranges::fill(state_.transforms, Transform{{k_nan, k_nan}, Rotation(SinCos{k_nan, k_nan})});
  std::fill_n(state_.outlines.begin(), state_.outlines.size() - partition::EdgeBlock::k_piece,
              Vec2(k_nan, k_nan));
  std::ranges::fill(state_.radii, k_nan);
  std::ranges::fill(state_.shapes, nullptr);
  std::ranges::fill(state_.not_drawn, std::uint8_t{0x5a});
  std::ranges::fill(next_born_, k_junk);
  for (std::size_t* count : {&robots_, &state_.now.absent, &state_.now.impaired}) *count = k_junk;
  links_.forget();
  std::ranges::fill(grid_lifts_, k_nan);
  experiment_.fault_events.clear();
  experiment_.due = 0;
  state_.index = partition::BodyIndex(state_.geometry);
  movement_.forget();
  placed_before_.set(Row(0), k_nowhere);
  derive();
  movement_.forget_motions();
}

/// Makes the grid of the grid ray engine, with the static scene. redraw_ray_grid() must follow.
void World::build_ray_grid(Diagnostics& diagnostics) {
  std::vector<partition::MovingOutline> outlines;
  for (std::uint32_t r = 0; r < rows(); ++r)
    for (const RayOutline& outline : type(Row(r)).outlines)
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

void World::redraw_ray_grid() {
  std::size_t o = 0;
  for (std::uint32_t r = 0; !grid_lifts_.empty() && r < rows(); ++r)
    for (const RayOutline& outline : type(Row(r)).outlines)
      if (outline.count > 0) grid_lifts_[o++] = lift(Row(r), outline.joint);
  partition::RayGrid::Linked linked{.lifts = grid_lifts_, .groups = {}, .absent = {}};
  if (state_.now.carried > 0) linked.groups = state_.roots;
  if (state_.now.absent > 0) linked.absent = state_.not_drawn;
  state_.ray_grid->redraw(state_.outlines, poses(), parallel_, linked);
}

BodyId World::find(std::string_view name) const {
  const std::optional<Name> wanted = state_.spec.names.find(name);
  if (!wanted) return {};
  std::call_once(names_made_, [this] {
    names_.reserve(state_.spec.bodies.size() + state_.spec.aliases.size());
    for (const NamedBody& alias : state_.spec.aliases) names_.set(alias.name, alias.body);
    for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b)
      names_.set(state_.spec.bodies[b].name, BodyId(b));
  });
  return names_.find(*wanted);
}

Estimates World::estimates(const BodyType& type) const {
  if (!type.drive) return {&k_true_pose, poses(), {}};
  Estimates estimates{&type.drive->localization, poses(), {}};
  if (type.drive->odometry_table) estimates.odometries = state_.as<Odometry>(*type.drive->odometry_table);
  return estimates;
}

void World::set_estimate(Row row, const Pose& pose) {
  require_whole();
  require_between_steps("set_estimate()");
  require_row(row, "set_estimate()");
  const auto& drive = type(row).drive;
  if (!drive || !drive->odometry_table)
    throw std::logic_error(
        fmt::format("\"{}\" has no odometry: its estimated pose is its true pose and cannot be set",
                    state_.spec.name(body(row))));
  if (!is_there(row))
    throw std::logic_error(fmt::format(
        "the estimated pose of \"{}\" cannot be set: the robot was removed from the world, or has not been "
        "added to it yet",
        state_.spec.name(body(row))));
  if (!is_finite(pose))
    throw std::invalid_argument(fmt::format(
        "the estimated pose of \"{}\" cannot be x {}, y {}, z {} (m), heading {} (rad): the numbers must "
        "be finite",
        state_.spec.name(body(row)), pose.x, pose.y, pose.z, pose.heading));
  touch();
  state_.as<Odometry>(*drive->odometry_table)[slot(row)] = {pose.x + 0.0, pose.y + 0.0,
                                                            wrap_angle(pose.heading) + 0.0};
}

void World::require_pose(BodyId body, const Pose& pose) const {
  const Box inside = state_.bounds();
  if (!is_finite(pose) || !inside.contains(pose.position()))
    throw std::invalid_argument(
        fmt::format("\"{}\" cannot be placed at x {}, y {}, z {} (m), heading {} (rad): {}",
                    state_.spec.name(body), pose.x, pose.y, pose.z, pose.heading,
                    is_finite(pose) ? outside_text(inside) : "the numbers must be finite"));
}

void World::set_poses(std::span<const Placed> placed) {
  require_whole();
  require_between_steps("set_poses()");
  restore_fp_environment();  // a library may have changed it: see step()
  for (const Placed& place : placed) {
    require_row(place.row, "set_poses()");
    if (!is_there(place.row))
      throw std::invalid_argument(fmt::format(
          "\"{}\" cannot be placed: it was removed from the world, or has not been added to it yet",
          state_.spec.name(body(place.row))));
    require_pose(body(place.row), place.pose);
    if (const std::optional<BodyId> by = carrier(place.row))
      throw std::invalid_argument(
          fmt::format("\"{}\" cannot be placed while \"{}\" carries it: release it first",
                      state_.spec.name(body(place.row)), state_.spec.name(*by)));
  }
  touch();
  for (const auto& [row, pose] : placed) place(row, pose);
  carry_placed();
  movement_.count_stalls();
  index_bodies();
}

/// Places a body that is not carried at a pose. carry_placed(), Movement::count_stalls() and index_bodies()
/// must follow; one call of each is enough for several bodies.
void World::place(Row row, const Pose& pose) {
  const Pose placed = at_start(pose);
  state_.poses()[row.index()] = placed;
  state_.stalls()[row.index()] = WorldState::k_free;
  if (state_.has_contacts()) state_.contact(row) = {};
  movement_.rest(row);
  state_.update_outlines(row, type(row), Transform(placed));
  remember_placed(row);
}

/// Called after place(): moves all carried bodies with their carriers.
void World::carry_placed() {
  if (state_.now.carried == 0) return;
  links_.carry();
  for (std::size_t r = 0; r < rows(); ++r)
    if (carrier(Row(r))) remember_placed(Row(r));
}

void World::remember_placed(Row row) { placed_.set(row, poses()[row.index()]); }

/// Called when a step begins: moves the list of the poses that were set since the last step from placed_ to
/// placed_before_.
void World::begin_placing() {
  placed_before_.swap(placed_);
  placed_.clear();
}

bool World::is_free(Row row, const Pose& pose) const {
  require_whole();
  require_row(row, "is_free()");
  if (!is_finite(pose)) return false;
  return is_free(body(row), is_there(row) ? *state_.shapes[row.index()] : type(row).obstacle, pose);
}

/// Whether the origin of the body `id` would be within the bounds at a pose, and the body, with this shape,
/// would overlap neither the static scene nor another body that is an obstacle. With an empty shape, only the
/// bounds count. The pose must be finite.
bool World::is_free(BodyId id, const partition::ObstacleShape& shape, const Pose& pose) const {
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
  const auto look_at_row = [&](std::uint32_t r) { look_at(state_.bodies[r], *state_.shapes[r], poses()[r]); };
  state_.index.for_each_near(Box::around(pose.position(), shape.radius),
                             [&](const partition::BodyCircle& other) { look_at_row(other.row); });
  for (const Newborn& other : newborn_) {
    if (location(other.body) == RowLocation::here)
      look_at_row(row(other.body).value);
    else  // its row is on another rank until the ranks distribute the rows
      look_at(other.body, state_.type(other.body).obstacle, other.pose);
  }
  return free;
}

bool World::stalled(Row row) const { return state_.stalls()[row.index()] != WorldState::k_free; }
bool World::is_out_of_bounds(Row row) const {
  return state_.stalls()[row.index()] == WorldState::k_out_of_bounds;
}

void World::watch_contacts() {
  require_between_steps("watch_contacts()");
  if (state_.watches_contacts) return;
  state_.watches_contacts = true;
  movement_.find_blocks();
  if (!state_.contact_table) state_.contacts.resize(rows());
}

Contact World::contact(Row row) const { return state_.has_contacts() ? state_.contact(row) : Contact(); }

void World::throw_half_made() const {
  throw std::logic_error(fmt::format(
      "tick {}: a step, a birth or a reset failed and left an incomplete state: call reset() before anything "
      "else",
      state_.now.tick));
}

void World::throw_in_tick(std::string_view call) {
  throw std::logic_error(fmt::format(
      "{} is not allowed during a step, for example in a callback of on_phase() or in a controller: call it "
      "between two steps",
      call));
}

void World::throw_in_before_tick(std::string_view call) {
  throw std::logic_error(
      fmt::format("{} is not allowed in a callback of before_tick(): call it outside the callback", call));
}

void World::throw_no_row(Row row, std::string_view call) const {
  throw std::out_of_range(
      row.valid()
          ? fmt::format("{}: found row {}, but the world has {} rows, counted from 0", call, row.value,
                        rows())
          : fmt::format("{}: found no row: static bodies, and bodies that do not exist, have none", call));
}

void World::throw_no_commands(const BodyType::Device& device) {
  throw std::logic_error(
      fmt::format("asked_of(): device \"{}\" ({}) takes no commands", device.name, device.kind->name));
}

void World::throw_frozen() {
  throw std::logic_error(
      "a measure must not change the world, for example with step(), reset() or set_poses(): measures only "
      "read");
}

void World::reset() {
  require_unfrozen();
  require_between_steps("reset()");
  restore_fp_environment();  // a library may have changed it: see step()
  if (replica_) replica_->reset();
  forget_settings();
  start();
}

void World::restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry) {
  require_unfrozen();
  require_between_steps("restart()");
  if (bodies.size() != state_.spec.bodies.size())
    throw std::invalid_argument(fmt::format("restart(): found {} bodies, but the world has {}", bodies.size(),
                                            state_.spec.bodies.size()));
  restore_fp_environment();  // a library may have changed it: see step()
  if (replica_) replica_->restart(seed, bodies);
  bool has_scene_changed = false;
  bool has_any_changed = false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodySpec& old = state_.spec.bodies[b];
    const bool has_moved = bodies[b].pose_world_body != old.pose_world_body;
    has_scene_changed = has_scene_changed || (has_moved && location(BodyId(b)) == RowLocation::none);
    has_any_changed = has_any_changed || has_moved || bodies[b].color != old.color;
  }
  Diagnostics diagnostics(state_.spec.files);  // build_faults() finds no error: the constructor has checked
  Groups groups(*this);
  const auto begin_with = [&](std::uint64_t next_seed, std::span<const BodySpec> next) {
    state_.spec.seed = next_seed;
    std::ranges::copy(next, state_.spec.bodies.begin());
    if (has_scene_changed) {
      build_scene();
      if (state_.ray_grid) build_ray_grid(diagnostics);  // start() redraws it
    }
    forget_settings();
    if (has_any_changed) bind_kinds_again(registry);
    build_faults(registry, groups, diagnostics);  // kinds of faults may read the devices of a type
    start();
  };
  if (!has_any_changed) return begin_with(seed, bodies);
  const std::uint64_t old_seed = state_.spec.seed;
  const std::vector<BodySpec> old = state_.spec.bodies;
  try {
    begin_with(seed, bodies);
  } catch (const StepError&) {
    throw;
  } catch (...) {  // a kind, or the ray grid, has refused the new bodies: the world returns to the old ones
    if (replica_) replica_->note_rejection();
    Diagnostics none(state_.spec.files);
    std::swap(diagnostics, none);
    begin_with(old_seed, old);
    throw;
  }
}

World::Counters World::counters() const {
  const Experiment::Present& present = experiment_.present;
  return {beams_, conflict_rounds_, present.tick == state_.now.tick ? present.settings : 0};
}

bool World::restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash,
                    const Fill& fill) {
  require_unfrozen();
  require_between_steps("restore()");
  restore_fp_environment();  // a library may have changed it: see step()
  is_half_made_ = false;
  if (replica_) replica_->replace();
  for (StateTable& table : state_.tables) table.clear();
  try {
    fill(state_.tables);
  } catch (...) {
    start();
    throw;
  }
  constexpr double k_reach = 2e6;  // m: larger than all bounds, and cell numbers still fit into 32 bits
  const auto stands_somewhere = [](const Pose& pose) {
    return std::abs(pose.x) < k_reach && std::abs(pose.y) < k_reach && std::isfinite(pose.z) &&
           std::isfinite(pose.heading);
  };
  const auto has_mode = [](const Command& command) {
    return static_cast<std::size_t>(command.mode) < k_control_modes;
  };
  if (hashes().state != state_hash || !std::ranges::all_of(poses(), stands_somewhere) ||
      !std::ranges::all_of(commands(), has_mode) ||
      !std::ranges::all_of(state_.tables, &StateTable::bools_hold) || !lives_hold(tick) ||
      !conditions_hold() || !links_.hold()) {
    start();
    return false;
  }
  state_.now.tick = tick;
  beams_ = counters.beams;
  conflict_rounds_ = counters.conflict_rounds;
  experiment_.present = {tick, counters.settings};
  derive();
  return true;
}

std::vector<BodyId> World::subscribed() const {
  std::vector<BodyId> bodies;
  for (std::size_t b = 0; b < state_.rows.size(); ++b)
    if (const BodyId body(b);
        location(body) == RowLocation::here && state_.subscribed[row(body).index()] != 0)
      bodies.push_back(body);
  return bodies;
}

std::uint64_t World::hash(const StateTable& table) {
  require_whole();
  require_between_steps("hash()");
  gather();
  return hash_of(parallel_, table, {0, table.rows()});
}

Hashes World::hashes() {
  require_whole();
  require_between_steps("hashes()");
  if (replica_)
    if (const std::optional<Hashes> sum = replica_->hashes()) return *sum;
  constexpr std::size_t k_block = 512;  // rows per task, in all tables: a loop per table would cost more
  std::size_t rows = 0;
  for (const StateTable& table : state_.tables) rows = std::max(rows, table.rows());
  std::array<std::atomic<std::uint64_t>, k_hash_groups> sums{};
  parallel_.for_batches(rows, k_block, [&](std::size_t first, std::size_t end) {
    for (const StateTable& table : state_.tables)
      if (first < table.rows())
        sums[static_cast<std::size_t>(table.group())].fetch_add(
            table.hash_rows(first, std::min(table.rows(), end)), std::memory_order_relaxed);
  });
  Hashes hashes;
  for (std::size_t g = 0; g < k_hash_groups; ++g) hashes.state += hashes.groups[g] = sums[g];
  return hashes;
}

double World::mean_displacement() const {
  require_whole();
  ExactSum sum;
  for (std::size_t r = 0; r < rows(); ++r)
    if (type(Row(r)).drive && is_there(Row(r))) sum.add((transform(Row(r)).position - origin(Row(r))).norm());
  return robots_ > 0 ? sum.value() / static_cast<double>(robots_) : 0;
}

}  // namespace troupe::engine
