#include "base/fp_environment.hpp"
#include "engine/kind_errors.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe::engine {
namespace {

// Rows per task. Crowded tiles are split and sparse ones merged so that every task is worth waking a thread.
constexpr std::size_t k_batch = 64;   // for work that reads neighbours
constexpr std::size_t k_block = 256;  // for work that does not read neighbours

std::string_view asked_for(ControlMode mode) {
  switch (mode) {
    case ControlMode::velocity: break;
    case ControlMode::acceleration: return "an acceleration";
    case ControlMode::position: return "to a goal";
  }
  return "a speed";
}

bool due(std::uint64_t tick, std::uint64_t period) { return tick % period == 0; }

Velocity scaled(const Velocity& v, double by) { return {v.x * by, v.y * by, v.turn * by}; }

}  // namespace

std::string_view phase_name(Phase phase) {
  switch (phase) {
    case Phase::intervene: return "intervene";
    case Phase::sense: return "sense";
    case Phase::actuate: return "actuate";
    case Phase::decide: return "decide";
    case Phase::move: return "move";
    case Phase::index: break;
  }
  return "index";
}

/// Each phase reads the state that the phase before it has written. Each task writes only its own rows.
/// Drives run before controllers, so a command takes effect one tick after the readings that it is based on.
void World::step() {
  require_whole();
  const Completion completion(*this);
  restore_fp_environment();  // a library loaded since the last step may have enabled fast maths
  begin(Phase::intervene);
  if (tick_ >= experiment_.due) intervene();
  if (before_tick_) before_tick_();
  ++tick_;
  begin_placing();
  begin(Phase::sense);
  sense();
  begin(Phase::actuate);
  actuate();
  begin(Phase::decide);
  decide();
  begin(Phase::move);
  move();
  begin(Phase::index);
  index_bodies();
  if (on_phase_) on_phase_(std::nullopt);
}

void World::begin(Phase phase) {
  if (on_phase_) on_phase_(phase);
}

template <class Work>
void World::for_neighbours(Work&& work) {
  const std::span<const std::uint32_t> order = index_.order();
  const std::size_t batches = (order.size() + k_batch - 1) / k_batch;
  parallel_.for_each(batches, [&](std::size_t b) {
    // Batches of nearly equal size: a short last one would not be worth waking a thread.
    const std::size_t first = order.size() * b / batches;
    const std::size_t count = order.size() * (b + 1) / batches - first;
    std::array<Row, k_batch> rows;
    for (std::size_t i = 0; i < count; ++i) rows[i] = Row(order[first + i]);
    for_types({rows.data(), count}, work);
  });
}

template <class Work>
void World::for_blocks(Work&& work) {
  const std::size_t blocks = (rows() + k_block - 1) / k_block;
  parallel_.for_each(blocks, [&](std::size_t b) {
    const std::size_t first = rows() * b / blocks;
    const std::size_t count = rows() * (b + 1) / blocks - first;
    std::array<Row, k_block> rows;
    std::size_t there = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (const Row row(first + i); is_there(row)) rows[there++] = row;
    for_types({rows.data(), there}, work);
  });
}

template <class Work>
void World::for_types(std::span<Row> rows, Work&& work) {
  const auto type_of = [&](Row row) { return row_types_[row.index()]; };
  if (!std::ranges::all_of(rows, [&](Row row) { return type_of(row) == type_of(rows.front()); })) {
    // Sorts the rows by type. The sort is stable, so that neighbours, which read the same data, stay
    // together.
    std::array<Row, k_block> mixed;
    std::ranges::copy(rows, mixed.begin());
    std::size_t done = 0;
    for (std::uint32_t type = 0; done < rows.size();) {
      std::uint32_t next = ~0u;
      for (const Row row : std::span(mixed).first(rows.size())) {
        const std::uint32_t t = type_of(row);
        if (t == type) rows[done++] = row;
        if (t > type) next = std::min(next, t);
      }
      type = next;
    }
  }
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && type_of(rows[end]) == type_of(rows[i])) ++end;
    work(std::span<const Row>(rows.subspan(i, end - i)), types_[type_of(rows[i])]);
    i = end;
  }
}

/// Calls work(rows) for those of `rows` that are due, once for each run of consecutive rows. A row is due if
/// the number of ticks since the birth of its body is a multiple of `period`. In a world without births, all
/// rows are due, or none.
template <class Work>
void World::for_due(std::span<const Row> rows, std::uint64_t period, Work&& work) {
  if (period == 1 || !life_table_) {
    if (due(tick_, period)) work(rows);
    return;
  }
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i;
    while (end < rows.size() && due(tick_ - birth_tick(rows[end]), period)) ++end;
    if (end > i) work(rows.subspan(i, end - i));
    i = end + 1;
  }
}

/// Calls work(rows) for those of `rows` whose device is due in this tick and runs(): it is active or
/// subscribed to, switched on, works and has power. There is one call for each run of consecutive rows.
template <class Work>
void World::for_running(std::span<const Row> rows, const BodyType::Device& device, Work&& work) {
  for_due(rows, device.period, [&](std::span<const Row> due_rows) {
    if (device.active && !device.supply && device.switch_bit == 0 && impaired_ == 0) return work(due_rows);
    for (std::size_t i = 0; i < due_rows.size();) {
      std::size_t end = i;
      while (end < due_rows.size() && runs(due_rows[end], device)) ++end;
      if (end > i) work(due_rows.subspan(i, end - i));
      i = end + 1;
    }
  });
}

/// Calls work(rows) once. If hide_beyond_reach() is on, calls work once per row instead. During the call for
/// a row, all bodies beyond the device's reach from that row are hidden.
template <class Work>
void World::for_seeing(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device,
                       Work&& work) {
  if (!blinkers_) return work(rows);
  for (const Row& row : rows) {
    hide_from(row, device.prepared.reach_m + type.joint_reach);
    work(std::span(&row, 1));
    show_hidden();
  }
}

void World::sense() {
  std::atomic<std::uint64_t> beams = 0;
  for_neighbours([&](std::span<const Row> rows, const BodyType& type) {
    for (const BodyType::Device& device : type.devices) {
      if (!device.kind->sense) continue;
      for_running(rows, device, [&](std::span<const Row> running) {
        for_seeing(running, type, device, [&](std::span<const Row> some) {
          const std::uint64_t cast = call_kind(
              *this, some, device, [&] { return device.kind->sense(device_batch(some, type, device)); });
          beams.fetch_add(cast, std::memory_order_relaxed);
        });
      });
    }
  });
  beams_ += beams;
}

/// Calls work(rows) for the rows that are neither disabled nor dropped out, in the same order.
template <class Work>
void World::for_enabled(std::span<const Row> rows, Work&& work) {
  if (impaired_ == 0) return work(rows);
  std::array<Row, k_block> enabled;
  std::size_t count = 0;
  for (const Row row : rows)
    if (condition(row).out == 0) enabled[count++] = row;
  work(std::span<const Row>(enabled).first(count));
}

void World::actuate() {
  std::atomic<std::uint32_t> faulty = BodyId().value;  // lowest id whose velocity is not finite
  const auto actuate_rows = [&](std::span<const Row> rows, const BodyType& type) {
    if (type.drive)
      for_due(rows, type.drive->period, [&](std::span<const Row> some) { drive(some, *type.drive, faulty); });
    if (type.drive && type.drive->supply) halt_spent(rows, *type.drive);
    for (const BodyType::Device& device : type.devices)
      if (device.kind->act)
        for_running(rows, device, [&](std::span<const Row> running) {
          for_seeing(running, type, device, [&](std::span<const Row> some) {
            call_kind(*this, some, device, [&] { device.kind->act(device_batch(some, type, device)); });
          });
        });
  };
  for_blocks([&](std::span<const Row> rows, const BodyType& type) {
    if (impaired_ > 0) halt_disabled(rows);
    for_enabled(rows, [&](std::span<const Row> enabled) { actuate_rows(enabled, type); });
  });
  if (const BodyId id(faulty.load()); id.valid()) {
    throw StepError(fmt::format("tick {}: robot \"{}\" was commanded {} that is not a finite number", tick_,
                                spec_.name(id), asked_for(commands()[row(id).index()].mode)));
  }
}

void World::decide() {
  for_blocks([&](std::span<const Row> present, const BodyType& type) {
    if (type.controllers.empty()) return;
    for_enabled(present, [&](std::span<const Row> rows) {
      for (const BodyType::Controller& controller : type.controllers)
        for_due(rows, controller.period, [&](std::span<const Row> some) { decide(some, type, controller); });
    });
  });
}

DeviceBatch World::device_batch(std::span<const Row> rows, const BodyType& type,
                                const BodyType::Device& sensor) {
  return {.world = *this,
          .data = sensor.prepared.data,
          .rows = rows,
          .state = tables_[sensor.table],
          .commands = sensor.command_table ? &tables_[*sensor.command_table] : nullptr,
          .effects = effects_,
          .links = links_,
          .device = static_cast<std::uint32_t>(&sensor - type.devices.data()),
          .stream = sensor.stream,
          .period_s = static_cast<double>(sensor.period) * spec_.tick_s};
}

void World::drive(std::span<const Row> rows, const BodyType::Drive& drive,
                  std::atomic<std::uint32_t>& faulty) {
  std::array<Command, k_block> commands;
  std::array<Velocity, k_block> velocities;
  bool speeds_only = true;
  const bool has_slow = impaired_ > 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    commands[i] = as<Command>(k_command)[rows[i].index()];
    speeds_only = speeds_only && commands[i].mode == ControlMode::velocity;
  }
  DriveBatch batch{.commands = {commands.data(), rows.size()},
                   .velocities = {velocities.data(), rows.size()},
                   .estimates = {},
                   .elapsed_s = static_cast<double>(drive.period) * spec_.tick_s};
  if (speeds_only) {
    call_kind(*this, rows, drive, [&] { drive.kind->drive(drive.data, batch); });
  } else {
    std::array<Pose, k_block> estimates;
    batch.estimates = {estimates.data(), rows.size()};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      velocities[i] = as<Velocity>(k_velocity)[rows[i].index()];
      if (has_slow) velocities[i] = scaled(velocities[i], 1 / speed_scale(rows[i]));
      estimates[i] = estimate(rows[i]);
    }
    call_kind(*this, rows, drive, [&] { drive.kind->drive(drive.data, batch); });
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Velocity v = has_slow ? scaled(velocities[i], speed_scale(rows[i])) : velocities[i];
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.turn)) {
      std::uint32_t lowest = faulty.load();
      const std::uint32_t id = body(rows[i]).value;
      while (id < lowest && !faulty.compare_exchange_weak(lowest, id)) {
      }
      continue;
    }
    // + 0.0 turns -0 into 0, so that equal velocities have equal bits.
    as<Velocity>(k_velocity)[rows[i].index()] = {v.x + 0.0, v.y + 0.0, v.turn + 0.0};
  }
}

/// Sets the velocity of disabled and dropped-out robots to 0, whatever their commands are.
void World::halt_disabled(std::span<const Row> rows) {
  for (const Row row : rows)
    if (condition(row).out != 0) as<Velocity>(k_velocity)[row.index()] = {};
}

/// Sets the velocity of robots whose power supply is empty to 0, whatever their commands are.
void World::halt_spent(std::span<const Row> rows, const BodyType::Drive& drive) {
  for (const Row row : rows)
    if (!is_supplied(row, drive.supply)) as<Velocity>(k_velocity)[row.index()] = {};
}

void World::decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller) {
  DecideBatch batch{.tick = tick_,
                    .time_s = time_s(),
                    .tick_s = spec_.tick_s,
                    .seed = spec_.seed,
                    .stream = controller.stream,
                    .rows = rows,
                    .ids = row_bodies_,
                    .slots = row_slots_,
                    .commands = as<Command>(k_command),
                    .estimates = estimates(type)};
  const auto rows_of = [this](std::size_t table) {
    return DecideBatch::Rows{tables_[table].row(0), tables_[table].row_bytes()};
  };
  for (const std::size_t sensor : controller.devices) {
    const BodyType::Device& chosen = type.devices[sensor];
    batch.percepts[batch.devices] = &percepts(chosen);
    batch.switches[batch.devices] = chosen.switch_bit;
    batch.device_commands[batch.devices++] =
        chosen.command_table ? rows_of(*chosen.command_table) : DecideBatch::Rows();
  }
  if (controller.table) batch.memories = rows_of(*controller.table);
  if (controller.drive) {
    const BodyType::Device& drive = type.devices[*controller.drive];
    batch.drive_commands = rows_of(*drive.command_table);
    batch.drive_state = &percepts(drive);
  }
  call_kind(*this, rows, controller, [&] {
    if (on_decide_)
      on_decide_(type, controller, batch);
    else
      controller.kind->decide(controller.data, batch);
  });
}

void World::move() {
  propose();
  Pushables pushables = pushables_;  // sizes with joints at rest and no cargo; enlarged below
  if (pushables.any())
    for (const std::uint32_t row : links_.composites) {
      if (row_pushable_[row] == 0) continue;
      pushables.radius = std::max(pushables.radius, row_shapes_[row]->radius);
      pushables.thinnest = std::min(pushables.thinnest, row_shapes_[row]->thinnest);
    }
  conflicts_.resolve({poses(), transforms_, motions_, row_shapes_, row_ids_, free_circles_, spec_.seed, tick_,
                      bounds(), pushables},
                     scene_, index_, parallel_);
  conflict_rounds_ += conflicts_.rounds();
  commit();
  if (pushables_.any()) commit_pushes();
  if (links_.any()) {
    resolve_joints();
    carry();
    report_joints();
  }
  apply_effects();
}

void World::apply_effects() {
  if (effects_.empty()) return;
  const std::span<const Effect> effects = effects_.sorted();
  bool any_of_life = false;
  for (const Effect& effect : effects) {
    any_of_life = any_of_life || effect.is_of_life();
    if (effect.is_of_life()) continue;
    const BodyType::Device& device = type(row(effect.source)).devices[effect.device];
    const Row source = row(effect.source);
    call_kind(*this, {&source, 1}, device, [&] { device.kind->apply(*this, device.prepared.data, effect); });
  }
  if (any_of_life) resolve_lives(effects);
  effects_.clear();
}

/// Calls the hook joints_moved of devices, so that they read the outcomes of the joint motions that they
/// commanded. Then clears these outcomes.
void World::report_joints() {
  if (!links_.asked.exchange(false, std::memory_order_relaxed)) return;
  for_blocks([&](std::span<const Row> rows, const BodyType& type) {
    if (type.joint_devices.empty()) return;
    for (const std::size_t d : type.joint_devices) {
      const BodyType::Device& device = type.devices[d];
      if (device.kind->joints_moved)
        call_kind(*this, rows, device, [&] { device.kind->joints_moved(device_batch(rows, type, device)); });
    }
    for (const Row row : rows)
      for (Links::Joint& joint : joints(row)) joint.state = Links::Goal::none;
  });
}

void World::propose() {
  const double dt = spec_.tick_s;
  const bool carrying = links_.carried > 0;  // carried bodies move with their carriers
  for_blocks([&](std::span<const Row> rows, const BodyType& type) {
    std::array<Motion*, k_block> turning;
    std::array<double, k_block> headings;
    std::array<SinCos, k_block> rotations;
    std::size_t count = 0;
    for (const Row row : rows) {
      const Velocity& v = velocities()[row.index()];
      Motion& motion = motions_[row.index()];
      motion.moves = type.drive && (v.x != 0 || v.y != 0 || v.turn != 0) && !(carrying && carrier(row));
      if (!motion.moves) continue;
      // Euler integration with the old heading, as in Stage.
      const Pose& from = poses()[row.index()];
      motion.turn = v.turn * dt;
      const Pose to = compose(from, transform(row), {v.x * dt, v.y * dt, 0, motion.turn});
      motion.to = {to.x + 0.0, to.y + 0.0, to.z + 0.0, to.heading + 0.0};
      motion.rotation = transform(row).rotation;
      if (to.heading == from.heading) continue;
      turning[count] = &motion;
      headings[count++] = motion.to.heading;
    }
    sincos({headings.data(), count}, {rotations.data(), count});
    for (std::size_t i = 0; i < count; ++i) turning[i]->rotation = Rotation(rotations[i]);
  });
}

void World::commit() {
  std::atomic<std::size_t> stalled = 0;
  std::atomic<std::size_t> out_of_bounds = 0;
  for_blocks([&](std::span<const Row> rows, const BodyType& type) {
    std::size_t blocked_here = 0;
    std::size_t out_of_bounds_here = 0;
    const bool has_odometry = type.drive && type.drive->odometry_table;
    for (const Row row : rows) {
      const Conflicts::Outcome outcome = conflicts_.outcome(row.index());
      if (outcome == Conflicts::Outcome::moved) {
        const Motion& motion = motions_[row.index()];
        as<Pose>(k_pose)[row.index()] = motion.to;
        update_outlines(row, type, motion.there());
        if (has_odometry) count_way(row, *type.drive);
      }
      const bool is_blocked = outcome == Conflicts::Outcome::blocked;
      const bool is_out_of_bounds = outcome == Conflicts::Outcome::out_of_bounds;
      stall()[row.index()] = is_blocked ? k_blocked : is_out_of_bounds ? k_out_of_bounds : k_free;
      blocked_here += is_blocked;
      out_of_bounds_here += is_out_of_bounds;
    }
    stalled.fetch_add(blocked_here + out_of_bounds_here, std::memory_order_relaxed);
    out_of_bounds.fetch_add(out_of_bounds_here, std::memory_order_relaxed);
  });
  stalled_ = stalled;
  out_of_bounds_ = out_of_bounds;
}

void World::commit_pushes() {
  const std::span<const Conflicts::Push> pushes = conflicts_.pushes();
  parallel_.for_each((pushes.size() + k_block - 1) / k_block, [&](std::size_t b) {
    for (const Conflicts::Push& push :
         pushes.subspan(b * k_block).first(std::min(k_block, pushes.size() - b * k_block))) {
      if (!conflicts_.is_last(push)) continue;
      const Row row(push.row);
      Pose& pose = as<Pose>(k_pose)[push.row];
      pose.x = push.position.x();
      pose.y = push.position.y();
      update_outlines(row, type(row), Transform{push.position, transform(row).rotation});
    }
  });
}

void World::count_way(Row row, const BodyType::Drive& drive) {
  const Velocity& v = velocities()[row.index()];
  const double dt = spec_.tick_s;
  as<Odometry>(*drive.odometry_table)[slot(row)].advance(
      drive.localization, row_odometry_errors_[row.index()], v.x * dt, v.y * dt, v.turn * dt);
}

void World::update_outlines(Row row, const BodyType& type, const Transform& transform) {
  transforms_[row.index()] = transform;
  if (!type.joints.empty()) return update_jointed_outlines(row, type, transform);
  Vec2* out = outlines_.data() + outline_begins_[row.index()];
  for (const Vec2& v : type.outline_vertices) *out++ = transform * v;
}

void World::index_bodies() {
  index_.rebuild(transforms_, row_radii_, parallel_);
  newborn_.clear();
  if (ray_grid_) redraw_ray_grid();
}

}  // namespace troupe::engine
