#include "base/fp_environment.hpp"
#include "base/raised.hpp"
#include "engine/conflicts/collision.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/state/batches.hpp"
#include "engine/state/blinkers.hpp"
#include "engine/world/kind_errors.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {
namespace {

/// Returns what is wrong with a command that is_command() rejects. Continues the words `robot "NAME" was
/// commanded`.
std::string_view wrong_command_text(ControlMode mode) {
  switch (mode) {
    case ControlMode::velocity: break;
    case ControlMode::acceleration: return "an acceleration that is not a finite number";
    case ControlMode::position: return "to drive to a goal pose that is not finite";
    default: return "in a mode that is no value of ControlMode";
  }
  return "a speed that is not a finite number";
}

bool is_command(const Command& command) {
  return is_finite(command) && static_cast<std::size_t>(command.mode) < k_control_modes;
}

/// Throws StepError because a device has emitted this effect. what: text that continues the words
/// `device "NAME"`
[[noreturn]] void throw_effect_error(const World& world, const Effect& effect, std::string_view what) {
  const BodyType::Device& device = world.type(world.row(effect.source)).devices[effect.device];
  throw StepError(fmt::format("tick {}: device \"{}\" ({}) of \"{}\" {}", world.tick(), device.name,
                              device.kind->name, world.spec().name(effect.source), what));
}

Velocity scaled(const Velocity& v, double by) { return {v.x * by, v.y * by, v.turn * by}; }

/// Whether the odometry estimate of a robot stays finite if the robot turns by `turn`, rad, in a tick. True
/// if the robot has no odometry. Other motions cannot make the estimate infinite, because they end within the
/// bounds of the world.
bool keeps_odometry_finite(const World& world, Row row, const BodyType::Drive& drive, double turn) {
  constexpr double k_large = 1e300;  // rad: with smaller turns, no error that is allowed has this effect
  return !drive.odometry_table || std::abs(turn) < k_large ||
         std::isfinite(turn * (1 + drive.localization.error_of(world.spec().seed, world.body(row)).turn));
}

void call_on_phase(Replica* replica, const std::function<void(std::optional<Phase>)>& callback,
                   std::optional<Phase> phase) {
  if (!callback) return;
  if (replica != nullptr)
    replica->observe([&] { callback(phase); });
  else
    callback(phase);
}

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

void World::step() {
  require_whole();
  require_unfrozen();
  require_outside_step("step()");
  const Completion completion(*this);
  // A library that was loaded since the last step may have made this thread flush denormals to zero.
  restore_fp_environment();
  if (replica_)
    replica_->tick(before_tick_ != nullptr, [this] { make_tick(); });
  else
    make_tick();
}

/// Computes the phases of one tick. Each phase reads the state that the previous phase has written. Each task
/// writes only its own rows. Drives run before controllers, so a command takes effect one tick after the
/// readings on which it is based. If several ranks compute the world, each of them senses, actuates and
/// decides for its own rows.
void World::make_tick() {
  // Not raised while a rank that has failed waits for the others: rank 0 may reset the world in its callback.
  const Raised in_tick(is_in_tick_);
  begin(Phase::intervene);
  if (state_.now.tick >= experiment_.due) intervene();
  is_in_tick_ = false;  // the callback may do what is allowed between two steps
  {
    const Raised in_before_tick(is_in_before_tick_);
    if (replica_)
      replica_->agree(before_tick_);
    else if (before_tick_)
      before_tick_();
  }
  is_in_tick_ = true;
  require_whole();  // the callback may have caught an exception that left the state incomplete
  // If the callback has replaced the state, for example by reset(), the interventions of that state are due.
  if (state_.now.tick >= experiment_.due) intervene();
  ++state_.now.tick;
  begin_placing();
  begin(Phase::sense);
  sense();
  begin(Phase::actuate);
  actuate();
  begin(Phase::decide);
  decide();
  if (replica_) replica_->exchange();
  begin(Phase::move);
  move();
  begin(Phase::index);
  index_bodies();
  call_on_phase(replica_, on_phase_, std::nullopt);
}

void World::begin(Phase phase) {
  if (replica_) replica_->begin(phase);
  call_on_phase(replica_, on_phase_, phase);
}

void World::BlinkersDeleter::operator()(Blinkers* blinkers) const { delete blinkers; }

void World::hide_beyond_reach(bool on) {
  if (on && (parallel_.threads() != 1 || state_.ray_grid))
    throw std::invalid_argument(fmt::format(
        "hide_beyond_reach() needs a world with one thread and the exact ray engine, found {} "
        "thread{} and the {} ray engine",
        parallel_.threads(), parallel_.threads() == 1 ? "" : "s", state_.ray_grid ? "grid" : "exact"));
  blinkers_.reset(on ? new Blinkers(state_) : nullptr);
}

/// Calls work(rows) once. If the test mode hide_beyond_reach() is on, calls work() once per row instead;
/// during each call, the data that Blinkers::hide_from() lists are hidden from the device.
template <class Work>
void World::for_seeing(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device,
                       Work&& work) {
  if (!blinkers_) return work(rows);
  for (const Row& row : rows) {
    const std::size_t emitted = effects_.emitted().size();
    // The reach is a distance from the origin of the body, but a joint can shift the device away from its
    // place at rest. BodyType::joint_reach bounds this shift, except for joints of drive devices
    // (DeviceKind::drives), which can move a part far away: a bound for them would make the cells of the
    // spatial index too wide. For these, the present shift of the device counts.
    const double shift =
        device.joint == k_rigid
            ? 0
            : state_.mounts(row)[static_cast<std::size_t>(device.joint)].transform.position.norm();
    blinkers_->hide_from(row, *device.kind, device.prepared.reach_m + std::max(type.joint_reach, shift));
    work(std::span(&row, 1));
    blinkers_->show_hidden(row, *device.kind);
    blinkers_->check_targets(device, effects_.emitted().subspan(emitted));
  }
}

/// The rows that this world senses, actuates and decides for.
RowRange World::own_rows() const { return replica_ ? replica_->own() : RowRange{0, rows()}; }

/// The number of rows for which sensing takes so long that it is worth waking a thread, estimated from the
/// rays that the rows have cast since tick 0. rows: number of rows that sense
std::size_t World::least_sensing_batch(std::size_t rows) const {
  constexpr double k_beams = 256;  // takes some 20 us
  const double beams_per_row =
      static_cast<double>(beams_) / (static_cast<double>(state_.now.tick) * static_cast<double>(rows));
  return beams_per_row * k_near_batch > k_beams ? 1 + static_cast<std::size_t>(k_beams / beams_per_row)
                                                : k_near_batch;
}

void World::sense() {
  std::atomic<std::uint64_t> beams = 0;
  const std::span<const std::uint32_t> order =
      replica_ ? replica_->own_of(state_.index.order()) : state_.index.order();
  const std::size_t least = least_sensing_batch(order.size());
  for_neighbours(state_, parallel_, order, least, [&](std::span<const Row> rows, const BodyType& type) {
    for (const BodyType::Device& device : type.devices) {
      if (!device.kind->sense) continue;
      for_running(state_, rows, device, [&](std::span<const Row> running) {
        for_seeing(running, type, device, [&](std::span<const Row> some) {
          const std::uint64_t cast = call_kind(*this, some, device, [&] {
            return device.kind->sense(SenseBatch{device_batch(some, type, device), state_.view});
          });
          beams.fetch_add(cast, std::memory_order_relaxed);
        });
      });
    }
  });
  beams_ += beams;
}

void World::actuate() {
  // Lowest id of the robots whose command, velocity or odometry is not finite.
  std::atomic<std::uint32_t> faulty = BodyId().value;
  const auto actuate_rows = [&](std::span<const Row> rows, const BodyType& type) {
    if (type.drive)
      for_due(state_, rows, type.drive->period,
              [&](std::span<const Row> some) { drive(some, *type.drive, faulty); });
    if (type.drive && type.drive->supply) halt_spent(rows, *type.drive);
    for (const BodyType::Device& device : type.devices) {
      if (device.kind->halt && (device.supply || state_.now.impaired > 0)) halt_stopped(rows, device);
      if (device.kind->act)
        for_running(state_, rows, device, [&](std::span<const Row> running) {
          for_seeing(running, type, device, [&](std::span<const Row> some) {
            call_kind(*this, some, device, [&] { device.kind->act(device_batch(some, type, device)); });
          });
        });
    }
  };
  for_blocks(state_, parallel_, own_rows(), [&](std::span<const Row> rows, const BodyType& type) {
    if (state_.now.impaired > 0) halt_disabled(rows, type);
    for_enabled(state_, rows, [&](std::span<const Row> enabled) { actuate_rows(enabled, type); });
  });
  if (const BodyId id(faulty.load()); id.valid()) {
    const Row row = this->row(id);
    const Command& command = commands()[row.index()];
    const double turn = velocities()[row.index()].turn * state_.spec.tick_s;
    const std::string& name = state_.spec.name(id);
    const std::string wrong =
        !is_command(command)
            ? fmt::format("robot \"{}\" was commanded {}", name, wrong_command_text(command.mode))
        : !keeps_odometry_finite(*this, row, *type(row).drive, turn)
            ? fmt::format(
                  "the odometry of robot \"{}\" computed a heading that is not a finite number, from a "
                  "turn of {:g} rad in a tick and the error of the turn in `odom_error`",
                  name, turn)
            : fmt::format("the drive of robot \"{}\" computed a velocity that is not a finite number", name);
    throw StepError(fmt::format("tick {}: {}", state_.now.tick, wrong), id);
  }
  check_effects();
}

/// Throws StepError if a device has emitted an effect that it must not emit. Kinds of plug-ins may do so.
void World::check_effects() {
  const auto is_wrong = [this](const Effect& effect) { return !check(effect); };
  if (std::ranges::none_of(effects_.emitted(), is_wrong)) return check_order(effects_.sorted());
  const Effect& effect = *std::ranges::find_if(effects_.sorted(), is_wrong);
  throw_effect_error(*this, effect, check(effect).error().text);
}

/// Throws StepError if a device of a body has emitted two effects with the same number: their order would
/// depend on the threads. effects: sorted
void World::check_order(std::span<const Effect> effects) const {
  const auto twin = std::ranges::adjacent_find(effects, [](const Effect& a, const Effect& b) {
    return a.source == b.source && a.device == b.device && a.sequence == b.sequence;
  });
  if (twin != effects.end())
    throw_effect_error(
        *this, *twin,
        fmt::format("emitted two effects with the number {} (Effect::sequence): each effect of a "
                    "device in a tick needs another number",
                    twin->sequence));
}

/// The text of the error continues the words `device "NAME"`.
Result<> World::check(const Effect& effect) const {
  const BodyType::Device& device = type(row(effect.source)).devices[effect.device];
  const std::size_t reserves = state_.spec.reserves.size();
  if (device.kind->is_sensor())
    return Error{"emitted an effect, but it is a sensor: only the hook \"act\" may emit effects"};
  if (effect.verb == k_birth && effect.reserve >= reserves)
    return Error{
        fmt::format("requested a birth from the reserve with index {} (counted from 0), but the "
                    "world has {} populations with a reserve",
                    effect.reserve, reserves)};
  if (effect.verb == k_death && !device.prepared.ends_lives)
    return Error{
        "requested a death, but its kind does not set DeviceKind::Prepared::ends_lives in prepare()"};
  if (!effect.is_of_life() && device.kind->apply == nullptr)
    return Error{"emitted an effect, but its kind has no hook \"apply\", which would apply it"};
  if (effect.target.valid() && effect.target.index() >= state_.rows.size())
    return Error{fmt::format("emitted an effect on the body with the id {}, but the largest id is {}",
                             effect.target.value, state_.rows.size() - 1)};
  return {};
}

void World::decide() {
  for_blocks(state_, parallel_, own_rows(), [&](std::span<const Row> present, const BodyType& type) {
    if (type.controllers.empty()) return;
    for_enabled(state_, present, [&](std::span<const Row> rows) {
      for (const BodyType::Controller& controller : type.controllers)
        if (!controller.kind->is_collective)
          for_due(state_, rows, controller.period,
                  [&](std::span<const Row> some) { decide(some, type, controller); });
    });
  });
  if (!has_collective_) return;
  if (replica_)
    replica_->on_rank_0([this] { decide_together(); });
  else
    decide_together();
}

/// Calls each controller with ControllerKind::is_collective once, for all its robots that are due in this
/// tick, in the order of their ids.
void World::decide_together() {
  const auto is_collective = [](const BodyType::Controller& controller) {
    return controller.kind->is_collective;
  };
  const auto type_of = [this](Row row) { return state_.row_types[row.index()]; };
  const auto type_and_id = [&](Row row) { return std::pair(type_of(row), state_.ids[row.index()]); };
  // First, one pass over the bodies lists the robots of all types, because each robot may have its own type.
  std::vector<Row>& rows = deciding_;
  rows.clear();
  for (std::size_t b = 0; b < state_.rows.size(); ++b) {
    if (location(BodyId(b)) != RowLocation::here) continue;
    const Row row = this->row(BodyId(b));
    if (is_there(row) && !is_disabled(row) && std::ranges::any_of(type(row).controllers, is_collective))
      rows.push_back(row);
  }
  if (!std::ranges::is_sorted(rows, {}, type_and_id)) std::ranges::sort(rows, {}, type_and_id);
  const std::size_t all = rows.size();
  for (std::size_t first = 0, end = 0; first < all; first = end) {
    const BodyType& type = this->type(rows[first]);
    while (end < all && type_of(rows[end]) == type_of(rows[first])) ++end;
    for (const BodyType::Controller& controller : type.controllers) {
      if (!is_collective(controller)) continue;
      rows.resize(all);  // removes the list of the controller before
      for (std::size_t i = first; i < end; ++i)
        if ((state_.now.tick - birth_tick(rows[i])) % controller.period == 0) rows.push_back(rows[i]);
      if (rows.size() > all) decide(std::span(rows).subspan(all), type, controller);
    }
  }
}

DeviceBatch World::device_batch(std::span<const Row> rows, const BodyType& type,
                                const BodyType::Device& device) {
  return {.view = state_.view,
          .data = device.prepared.data,
          .rows = rows,
          .state = state_.tables[device.table],
          .commands = device.command_table ? &state_.tables[*device.command_table] : nullptr,
          .effects = effects_,
          .links = links_,
          .device = static_cast<std::uint32_t>(&device - type.devices.data()),
          .stream = device.stream,
          .period_s = static_cast<double>(device.period) * state_.spec.tick_s};
}

void World::drive(std::span<const Row> rows, const BodyType::Drive& drive,
                  std::atomic<std::uint32_t>& faulty) {
  std::array<Command, k_row_block> commands;
  std::array<Velocity, k_row_block> velocities;
  bool speeds_only = true;
  const bool has_slow = state_.now.impaired > 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    commands[i] = state_.as<Command>(WorldState::k_command)[rows[i].index()];
    speeds_only = speeds_only && commands[i].mode == ControlMode::velocity;
  }
  DriveBatch batch{.commands = {commands.data(), rows.size()},
                   .velocities = {velocities.data(), rows.size()},
                   .estimates = {},
                   .elapsed_s = static_cast<double>(drive.period) * state_.spec.tick_s};
  if (speeds_only) {
    call_kind(*this, rows, drive, [&] { drive.kind->drive(drive.data, batch); });
  } else {
    std::array<Pose, k_row_block> estimates;
    batch.estimates = {estimates.data(), rows.size()};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      velocities[i] = state_.as<Velocity>(WorldState::k_velocity)[rows[i].index()];
      if (has_slow) velocities[i] = scaled(velocities[i], 1 / speed_scale(rows[i]));
      estimates[i] = estimate(rows[i]);
    }
    call_kind(*this, rows, drive, [&] { drive.kind->drive(drive.data, batch); });
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Velocity v = has_slow ? scaled(velocities[i], speed_scale(rows[i])) : velocities[i];
    const Velocity motion = scaled(v, state_.spec.tick_s);
    const Command& command = commands[i];  // tested too: a drive may clamp an infinite command
    const bool is_velocity = is_command(command) && is_finite(motion);
    // + 0.0 turns -0 into 0, so that equal velocities have equal bits.
    if (is_velocity)
      state_.as<Velocity>(WorldState::k_velocity)[rows[i].index()] = {v.x + 0.0, v.y + 0.0, v.turn + 0.0};
    if (is_velocity && keeps_odometry_finite(*this, rows[i], drive, motion.turn)) continue;
    std::uint32_t lowest = faulty.load();
    const std::uint32_t id = body(rows[i]).value;
    while (id < lowest && !faulty.compare_exchange_weak(lowest, id)) {
    }
  }
}

/// Sets the velocity of robots that are disabled or dropped out by a fault to 0, whatever their commands are,
/// and that of their drive devices.
void World::halt_disabled(std::span<const Row> rows, const BodyType& type) {
  for (const Row row : rows) {
    if (state_.condition(row).out == 0) continue;
    state_.as<Velocity>(WorldState::k_velocity)[row.index()] = {};
    for (const BodyType::Device& device : type.devices)
      if (device.kind->halt) halt(row, device);
  }
}

/// Sets the velocity of robots whose power supply is empty to 0, whatever their commands are.
void World::halt_spent(std::span<const Row> rows, const BodyType::Drive& drive) {
  for (const Row row : rows)
    if (!is_supplied(row, drive.supply)) state_.as<Velocity>(WorldState::k_velocity)[row.index()] = {};
}

/// Sets the velocity of a drive device to 0 for the enabled bodies whose device is broken or has no power.
void World::halt_stopped(std::span<const Row> rows, const BodyType::Device& device) {
  for (const Row row : rows)
    if (!state_.view.works(row, device) || !is_supplied(row, device.supply)) halt(row, device);
}

void World::halt(Row row, const BodyType::Device& device) {
  call_kind(*this, {&row, 1}, device, [&] { device.kind->halt(state_.tables[device.table], slot(row)); });
}

void World::decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller) {
  DecideBatch batch{.tick = state_.now.tick,
                    .time_s = time_s(),
                    .tick_s = state_.spec.tick_s,
                    .period_s = static_cast<double>(controller.period) * state_.spec.tick_s,
                    .seed = state_.spec.seed,
                    .stream = controller.stream,
                    .rows = rows,
                    .ids = state_.bodies,
                    .slots = state_.slots,
                    .commands = state_.as<Command>(WorldState::k_command),
                    .stalls = state_.stalls(),
                    .contacts = state_.contact_table ? state_.as<Contact>(*state_.contact_table)
                                                     : std::span<const Contact>(),
                    .estimates = estimates(type)};
  const auto rows_of = [this](std::size_t table) {
    return DecideBatch::Rows{state_.tables[table].row(0), state_.tables[table].row_bytes()};
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
  movement_.propose();
  movement_.resolve(links_.composites(), replica_ ? replica_->border() : nullptr);
  conflict_rounds_ += movement_.rounds();
  if (has_collisions_) report_collisions();
  movement_.commit();
  if (links_.any()) {
    links_.resolve_joints(movement_.longest(), replica_ ? replica_->border() : nullptr);
    links_.carry();
  }
  if (replica_)
    replica_->report_joints([this] { report_joints(); });
  else
    report_joints();
  apply_effects();
}

/// Calls the hook collide of the devices of the own rows whose body ran into another one in this tick, or was
/// run into: for each body in the order of the ids of the movers. The bodies are still at their old poses.
void World::report_collisions() {
  if (replica_ && replica_->border()) replica_->border()->exchange_blocks(movement_.blocks());
  felt_.clear();
  const std::span<const Conflicts::Block> blocks = movement_.blocks();
  for (std::uint32_t r = 0; r < blocks.size(); ++r) {
    if (blocks[r].sample == 0) continue;
    add_feelers(Row(r), r);
    const BodyId other = blocks[r].contact.blocker();
    if (location(other) == RowLocation::here) add_feelers(row(other), r);
  }
  std::ranges::sort(felt_, {},
                    [this](const Felt& felt) { return std::pair(felt.feeler, state_.ids[felt.mover]); });
  constexpr std::size_t k_batch = 16;
  parallel_.for_batches(felt_.size(), k_batch, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      if (i > 0 && felt_[i - 1].feeler == felt_[i].feeler) continue;  // the task of the first one does all
      for (std::size_t j = i; j < felt_.size() && felt_[j].feeler == felt_[i].feeler; ++j) {
        const auto& [feeler, mover, as_mover] = felt_[j];
        const BodyId other = blocks[mover].contact.blocker();
        const Row blocker = location(other) == RowLocation::here ? row(other) : Row();
        const Collision::Sides sides = movement_.collision(mover, blocker.value, as_mover);
        const BodyType& type = state_.type(feeler);
        for (const std::size_t d : type.collision_devices) {
          const BodyType::Device& device = type.devices[d];
          const DeviceBatch batch = device_batch({&feeler, 1}, type, device);
          if (batch.runs(0, d)) device.kind->collide(batch, Collision(sides));
        }
      }
    }
  });
}

/// Adds the bodies of a tree whose devices feel a collision of `mover` to felt_.
void World::add_feelers(Row root, std::uint32_t mover) {
  const RowRange own = own_rows();
  const auto add = [&](Row row) {
    if (own.first <= row.index() && row.index() < own.end && !type(row).collision_devices.empty())
      felt_.push_back({row, mover, root.value == mover});
  };
  add(root);
  if (state_.now.carried == 0 || !links_.any()) return;
  std::vector<Row> cargo;
  links_.add_cargo(root, cargo);
  std::ranges::for_each(cargo, add);
}

/// Throws std::logic_error if the hook `apply` of a kind is running that does not declare `carries`. If such
/// a hook changed a tree, distributed ranks would apply later effects on the tree to an old state of it
/// (SharedEffects). call: the function of World that the hook has called
void World::require_carries(std::string_view call) const {
  if (!must_not_carry_) return;
  throw std::logic_error(
      fmt::format("World::{} was called by a kind that does not declare that it can carry bodies: set "
                  "DeviceKind::carries to true",
                  call));
}

void World::apply_effects() {
  if (effects_.empty()) return;
  const std::span<const Effect> effects = effects_.sorted();
  const auto apply = [&](const Effect& effect) {
    if (effect.is_of_life()) return;
    const BodyType::Device& device = type(row(effect.source)).devices[effect.device];
    const Row source = row(effect.source);
    call_kind(*this, {&source, 1}, device, [&] {
      if (blinkers_) blinkers_->begin_effect(effect);
      std::optional<Raised> plain;
      if (!device.kind->carries) plain.emplace(must_not_carry_);
      device.kind->apply(*this, device.prepared.data, effect);
      if (blinkers_) blinkers_->end_effect(device, effect);
    });
  };
  if (replica_)
    replica_->apply_effects(effects, apply);
  else
    std::ranges::for_each(effects, apply);
  if (std::ranges::any_of(effects, &Effect::is_of_life)) resolve_lives(effects);
  effects_.clear();
}

/// Calls the hook joints_moved of devices, which reads the outcomes of the joint motions that the devices
/// have requested in this tick. Then clears these outcomes. Does nothing if no device has requested a joint
/// motion.
void World::report_joints() {
  if (!links_.take_asked()) return;
  for_blocks(state_, parallel_, [&](std::span<const Row> rows, const BodyType& type) {
    if (type.joint_devices.empty()) return;
    for (const std::size_t d : type.joint_devices) {
      const BodyType::Device& device = type.devices[d];
      if (device.kind->joints_moved)
        call_kind(*this, rows, device, [&] { device.kind->joints_moved(device_batch(rows, type, device)); });
    }
    for (const Row row : rows) links_.clear_goals(row);
  });
}

void World::index_bodies() {
  state_.index.rebuild(state_.transforms, state_.radii, parallel_);
  newborn_.clear();
  if (state_.ray_grid) redraw_ray_grid();
}

}  // namespace troupe::engine
