#include "engine/world/world.hpp"

#include "base/fp_environment.hpp"
#include "engine/kinds/finite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

namespace troupe::engine {

// ---- Running

void World::start() {
  const Activities::Change change(activities_);
  state_.now.tick = 0;
  tick_.restore_counts(0, 0);
  interventions_.derive();  // first, because bodies start with the parameters of tick 0
  for (StateTable& table : state_.tables) table.clear();
  lives_.start();
  derivation_.derive();
}

void World::step() {
  activities_.require(Access::step, "step()");
  const Activities::Change change(activities_);
  // A library that was loaded since the last step may have made this thread flush denormals to zero.
  restore_fp_environment();
  ranks_->tick(tick_.has_before_tick(), [this] { tick_.run(); });
}

void World::reset() {
  activities_.require(Access::replace, "reset()");
  restore_fp_environment();  // a library may have changed it: see step()
  ranks_->reset();
  interventions_.forget_settings();
  start();
}

void World::restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry) {
  activities_.require(Access::replace, "restart()");
  if (bodies.size() != state_.spec.bodies.size())
    throw std::invalid_argument(fmt::format("restart(): found {} bodies, but the world has {}", bodies.size(),
                                            state_.spec.bodies.size()));
  restore_fp_environment();  // a library may have changed it: see step()
  ranks_->restart(seed, bodies);
  bool has_scene_changed = false;
  bool has_any_changed = false;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodySpec& old = state_.spec.bodies[b];
    const bool has_moved = bodies[b].pose_world_body != old.pose_world_body;
    has_scene_changed =
        has_scene_changed || (has_moved && state_.view.location(BodyId(b)) == RowLocation::none);
    has_any_changed = has_any_changed || has_moved || bodies[b].color != old.color;
  }
  Diagnostics diagnostics(
      state_.spec.files);  // Interventions::rebuild() finds no error: the constructor has checked
  const auto begin_with = [&](std::uint64_t next_seed, std::span<const BodySpec> next) {
    state_.spec.seed = next_seed;
    std::ranges::copy(next, state_.spec.bodies.begin());
    if (has_scene_changed) {
      build_scene();
      if (state_.ray_grid) places_.build_ray_grid(diagnostics);  // start() redraws it
    }
    interventions_.rebuild(has_any_changed, registry, diagnostics);
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
    ranks_->note_rejection();
    Diagnostics none(state_.spec.files);
    std::swap(diagnostics, none);
    begin_with(old_seed, old);
    throw;
  }
}

World::Counters World::counters() const {
  return {tick_.beams(), tick_.conflict_rounds(), interventions_.settings_now()};
}

bool World::restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash,
                    const Fill& fill) {
  activities_.require(Access::replace, "restore()");
  restore_fp_environment();  // a library may have changed it: see step()
  activities_.complete();
  ranks_->replace();
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
  if (hashes().state != state_hash || !std::ranges::all_of(state_.poses(), stands_somewhere) ||
      !std::ranges::all_of(state_.view.commands(), has_mode) ||
      !std::ranges::all_of(state_.tables, &StateTable::bools_hold) || !lives_.hold(tick) ||
      !interventions_.hold() || !links_.hold()) {
    start();
    return false;
  }
  state_.now.tick = tick;
  tick_.restore_counts(counters.beams, counters.conflict_rounds);
  interventions_.restore_settings(counters.settings);
  derivation_.derive();
  return true;
}

void World::forget() { derivation_.forget(); }

void World::hide_beyond_reach(bool on) { tick_.hide_beyond_reach(on); }

void World::on_phase(Tick::OnPhase callback) {
  activities_.require(Access::listen, "on_phase()");  // in its own callback, it would destroy the callback
  tick_.on_phase(std::move(callback));
}

void World::before_tick(Tick::BeforeTick callback) {
  activities_.require(Access::prepare, "before_tick()");  // as in on_phase()
  tick_.before_tick(std::move(callback));
}

// ---- Rows

void World::begin_row_change(std::string_view what) const {
  activities_.require(Access::read, {});
  if (ranks_->are_several())
    throw std::logic_error(fmt::format("the rows of a world that several ranks compute cannot be {}", what));
  restore_fp_environment();  // a library may have changed it: see step()
}

void World::shuffle_rows(std::uint64_t seed) {
  begin_row_change("shuffled");
  const Activities::Change change(activities_);
  rows_.shuffle(seed);
  derivation_.derive_rows();
}

std::vector<RowState> World::remove_rows(std::span<const BodyId> bodies) {
  begin_row_change("removed");
  std::vector<RowState> removed = rows_.take(bodies);
  const Activities::Change change(activities_);
  derivation_.derive_rows();
  return removed;
}

void World::add_rows(std::span<const RowState> added) {
  begin_row_change("added");
  rows_.add(added);
  const Activities::Change change(activities_);
  derivation_.derive_rows();
}

// ---- Settings

Result<> World::set(const SettingSpec& setting, const Registry& registry) {
  activities_.require(Access::change, "set()");
  if (!has_params(state_.spec.types, setting))
    return Error{"refers to a type, or to a drive, device or controller of a type, that does not exist"};
  Result<> done = interventions_.set(setting, registry);
  if (done) ranks_->set(setting);
  return done;
}

// ---- Changes of a program

void World::set_estimate(Row row, const Pose& pose) {
  activities_.require(Access::change, "set_estimate()");
  require_row(row, "set_estimate()");
  const auto& drive = state_.type(row).drive;
  if (!drive || !drive->odometry_table)
    throw std::logic_error(
        fmt::format("\"{}\" has no odometry: its estimated pose is its true pose and cannot be set",
                    state_.spec.name(state_.view.body(row))));
  if (!state_.view.is_there(row))
    throw std::logic_error(fmt::format(
        "the estimated pose of \"{}\" cannot be set: the robot was removed from the world, or has not been "
        "added to it yet",
        state_.spec.name(state_.view.body(row))));
  if (!is_finite(pose))
    throw std::invalid_argument(fmt::format(
        "the estimated pose of \"{}\" cannot be x {}, y {}, z {} (m), heading {} (rad): the numbers must "
        "be finite",
        state_.spec.name(state_.view.body(row)), pose.x, pose.y, pose.z, pose.heading));
  touch();
  state_.as<Odometry>(*drive->odometry_table)[state_.slots[row.index()]] = {pose.x + 0.0, pose.y + 0.0,
                                                                            wrap_angle(pose.heading) + 0.0};
}

void World::set_poses(std::span<const Placed> placed) {
  activities_.require(Access::change, "set_poses()");
  restore_fp_environment();  // a library may have changed it: see step()
  for (const Placed& place : placed) {
    require_row(place.row, "set_poses()");
    if (!state_.view.is_there(place.row))
      throw std::invalid_argument(fmt::format(
          "\"{}\" cannot be placed: it was removed from the world, or has not been added to it yet",
          state_.spec.name(state_.view.body(place.row))));
    require_place(state_, state_.view.body(place.row), place.pose);
    if (const std::optional<BodyId> by = state_.view.carrier(place.row))
      throw std::invalid_argument(
          fmt::format("\"{}\" cannot be placed while \"{}\" carries it: release it first",
                      state_.spec.name(state_.view.body(place.row)), state_.spec.name(*by)));
  }
  touch();
  for (const auto& [row, pose] : placed) places_.place(row, pose);
  places_.carry_placed();
  movement_.count_stalls();
  places_.index();
}

bool World::is_free(Row row, const Pose& pose) const {
  require_whole();
  require_row(row, "is_free()");
  if (!is_finite(pose)) return false;
  return places_.is_free(state_.view.body(row),
                         state_.view.is_there(row) ? *state_.shapes[row.index()] : state_.type(row).obstacle,
                         pose);
}

Birth World::spawn(std::size_t reserve, const Pose& pose) {
  activities_.require(Access::change, "spawn()");
  if (reserve >= state_.spec.reserves.size())
    throw std::out_of_range(
        fmt::format("spawn(): found reserve {}, but the world has {} reserves, counted from 0", reserve,
                    state_.spec.reserves.size()));
  restore_fp_environment();  // a library may have changed it: see step()
  if (!is_finite(pose))
    throw std::invalid_argument(
        fmt::format("a body of population \"{}\" cannot be placed at x {}, y {}, z {} (m), heading {} (rad): "
                    "the numbers must be finite",
                    state_.spec.reserves[reserve].population, pose.x, pose.y, pose.z, pose.heading));
  touch();
  const Activities::Change change(activities_);
  const Birth birth = lives_.give_birth(reserve, 1, [&pose](std::uint32_t) { return pose; });
  if (birth.status == BirthStatus::born) places_.index();
  return birth;
}

void World::remove(Row row) {
  activities_.require(Access::change, "remove()");
  require_row(row, "remove()");
  restore_fp_environment();  // a library may have changed it: see step()
  if (!state_.life_table)
    throw std::logic_error(
        "programs cannot remove bodies of this world: add \"mortal\": true to the world file, or set this "
        "key when you load the world (in C++: SimulationOptions::mortal; in Python: "
        "set={\"/mortal\": True}); worlds with a \"reserve\", a device that removes bodies, or an "
        "intervention \"remove\" need neither");
  if (!state_.view.is_there(row)) return;
  touch();
  lives_.die(row);
  movement_.count_stalls();
  places_.index();
}

bool World::set_disabled(Row row, bool disabled) {
  activities_.require(Access::change, disabled ? "disable()" : "enable()");
  require_row(row, disabled ? "disable()" : "enable()");
  if (!state_.condition_table)
    throw std::logic_error(fmt::format(
        "programs cannot disable \"{}\": add \"mortal\": true to the world file, or set this key when you "
        "load the world (in C++: SimulationOptions::mortal; in Python: set={{\"/mortal\": True}}); worlds "
        "with faults, or with an intervention \"disable\" or \"enable\", need neither",
        state_.spec.name(state_.view.body(row))));
  if (!state_.view.is_there(row) || ((state_.condition(row).out & Condition::k_disabled) != 0) == disabled)
    return false;
  touch();
  interventions_.toggle_disabled(row);
  return true;
}

void World::set_command(Row row, const Command& command) {
  activities_.require(Access::change, "set_command()");
  require_row(row, "set_command()");
  touch();
  state_.tables[WorldState::k_command].as<Command>(row.index()) = command;
}

std::byte* World::device_command(Row row, const BodyType::Device& device) {
  require_between_steps("device_command()");
  require_row(row, "device_command()");
  if (!device.command_table)
    throw std::logic_error(fmt::format("device_command(): device \"{}\" ({}) takes no commands", device.name,
                                       device.kind->name));
  touch();
  return state_.tables[*device.command_table].row(state_.slots[row.index()]);
}

void World::subscribe(BodyId body) {
  gather_distributed();  // the row may be on another rank
  const Row row = body.index() < state_.rows.size() ? state_.view.row(body) : Row();
  require_row(row, "subscribe()");
  touch();
  state_.subscribed[row.index()] = 1;
}

void World::watch_contacts() {
  activities_.require(Access::listen, "watch_contacts()");
  if (state_.watches_contacts) return;
  state_.watches_contacts = true;
  movement_.find_blocks();
  if (!state_.contact_table) state_.contacts.resize(state_.row_count());
  state_.bind_view();
}

// ---- Reading

std::span<const StateTable> World::tables() const {
  require_whole();
  gather();
  return state_.tables;
}

std::size_t World::robots() const {
  gather_distributed();
  return lives_.robots();
}

Hashes World::hashes() {
  activities_.require(Access::examine, "hashes()");
  if (const std::optional<Hashes> sum = ranks_->hashes()) return *sum;
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

void World::attach(Ranks* ranks) {
  ranks_.attach(ranks);
  ranks_->join(access_);
}

void World::require_row(Row row, std::string_view call) const {
  if (row.index() >= state_.row_count()) throw_no_row(row, call);
}

void World::touch() {
  activities_.require(Access::touch, {});
  ranks_->touch();
}

void World::throw_no_row(Row row, std::string_view call) const {
  throw std::out_of_range(
      row.valid()
          ? fmt::format("{}: found row {}, but the world has {} rows, counted from 0", call, row.value,
                        state_.row_count())
          : fmt::format("{}: found no row: static bodies, and bodies that do not exist, have none", call));
}

}  // namespace troupe::engine
