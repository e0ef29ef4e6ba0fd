#include "engine/world/tick.hpp"

#include "engine/conflicts/collision.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/state/batches.hpp"
#include "engine/state/blinkers.hpp"
#include "engine/state/kind_calls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace troupe::engine {
namespace {

/// Throws StepError because a device has emitted this effect. what: text that continues the words
/// `device "NAME"`
[[noreturn]] void throw_effect_error(const CommittedView& world, const Effect& effect,
                                     std::string_view what) {
  const BodyType::Device& device = world.type(world.row(effect.source)).devices[effect.device];
  throw StepError(fmt::format("tick {}: device \"{}\" ({}) of \"{}\" {}", world.tick(), device.name,
                              device.kind->name, world.spec().name(effect.source), what));
}

/// The text of the error continues the words `device "NAME"`.
Result<> check(const WorldState& state, const Effect& effect) {
  const BodyType::Device& device = state.type(state.view.row(effect.source)).devices[effect.device];
  const std::size_t reserves = state.spec.reserves.size();
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
  if (effect.target.valid() && effect.target.index() >= state.rows.size())
    return Error{fmt::format("emitted an effect on the body with the id {}, but the largest id is {}",
                             effect.target.value, state.rows.size() - 1)};
  return {};
}

/// Throws StepError if a device of a body has emitted two effects with the same number: their order would
/// depend on the threads. effects: sorted
void check_order(const CommittedView& world, std::span<const Effect> effects) {
  const auto twin = std::ranges::adjacent_find(effects, [](const Effect& a, const Effect& b) {
    return a.source == b.source && a.device == b.device && a.sequence == b.sequence;
  });
  if (twin != effects.end())
    throw_effect_error(
        world, *twin,
        fmt::format("emitted two effects with the number {} (Effect::sequence): each effect of a "
                    "device in a tick needs another number",
                    twin->sequence));
}

}  // namespace

Tick::Tick(const TickParts& parts)
    : state_(parts.state),
      parallel_(parts.parallel),
      links_(parts.links),
      movement_(parts.movement),
      places_(parts.places),
      lives_(parts.lives),
      interventions_(parts.interventions),
      ranks_(parts.ranks),
      activities_(parts.activities),
      actuation_(parts.state) {}

Tick::~Tick() = default;

void Tick::build() {
  std::size_t effects = 0;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    const BodyType& type = state_.types[t];
    for (const BodyType::Controller& controller : type.controllers)
      has_collective_ = has_collective_ || controller.kind->is_collective;
    has_collisions_ = has_collisions_ || !type.collision_devices.empty();
    for (const BodyType::Device& device : type.devices)
      effects += device.prepared.most_effects * state_.pools[t].rows;
  }
  effects_.reserve(effects);
  if (state_.contact_table || has_collisions_) movement_.find_blocks();
}

void Tick::run() {
  // Not while a rank that has failed waits for the others: rank 0 may reset the world in its callback.
  const Activities::During step(activities_, Activity::step);
  begin(Phase::intervene);
  if (interventions_.are_due()) interventions_.apply_due();
  {
    const Activities::During callback(activities_, Activity::callback);
    ranks_->agree(before_tick_);
  }
  activities_.require(Access::read, "step()");  // the callback may have caught an exception
  // If the callback has replaced the state, for example by reset(), the interventions of that state are due.
  if (interventions_.are_due()) interventions_.apply_due();
  ++state_.now.tick;
  places_.begin_step();
  begin(Phase::sense);
  sense();
  begin(Phase::actuate);
  actuate();
  begin(Phase::decide);
  decide();
  ranks_->exchange();
  begin(Phase::move);
  move();
  begin(Phase::index);
  places_.index();
  call_on_phase(std::nullopt);
}

void Tick::begin(Phase phase) {
  ranks_->begin(phase);
  call_on_phase(phase);
}

void Tick::call_on_phase(std::optional<Phase> phase) {
  if (!on_phase_) return;
  const auto call = [&] { on_phase_(phase); };
  ranks_->observe(std::ref(call));
}

void Tick::hide_beyond_reach(bool on) {
  if (on && (parallel_.threads() != 1 || state_.ray_grid))
    throw std::invalid_argument(fmt::format(
        "hide_beyond_reach() needs a world with one thread and the exact ray engine, found {} "
        "thread{} and the {} ray engine",
        parallel_.threads(), parallel_.threads() == 1 ? "" : "s", state_.ray_grid ? "grid" : "exact"));
  blinkers_ = on ? std::make_unique<Blinkers>(state_) : nullptr;
}

void Tick::follow_rows() {
  if (blinkers_) blinkers_ = std::make_unique<Blinkers>(state_);
}

/// Calls work(rows) once. If the test mode hide_beyond_reach() is on, calls work() once per row instead;
/// during each call, the data that Blinkers::hide_from() lists are hidden from the device.
template <class Work>
void Tick::for_seeing(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device,
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

/// The number of rows for which sensing takes so long that it is worth waking a thread, estimated from the
/// rays that the rows have cast since tick 0. rows: number of rows that sense
std::size_t Tick::least_sensing_batch(std::size_t rows) const {
  constexpr double k_beams = 256;  // takes some 20 us
  const double beams_per_row =
      static_cast<double>(beams_) / (static_cast<double>(state_.now.tick) * static_cast<double>(rows));
  return beams_per_row * k_near_batch > k_beams ? 1 + static_cast<std::size_t>(k_beams / beams_per_row)
                                                : k_near_batch;
}

void Tick::sense() {
  std::atomic<std::uint64_t> beams = 0;
  const std::span<const std::uint32_t> order = ranks_->own_of(state_.index.order());
  const std::size_t least = least_sensing_batch(order.size());
  for_neighbours(state_, parallel_, order, least, [&](std::span<const Row> rows, const BodyType& type) {
    for (const BodyType::Device& device : type.devices) {
      if (!device.kind->sense) continue;
      for_running(state_, rows, device, [&](std::span<const Row> running) {
        for_seeing(running, type, device, [&](std::span<const Row> some) {
          const std::uint64_t cast = call_kind(state_.view, some, device, [&] {
            return device.kind->sense(SenseBatch{device_batch(some, type, device), state_.view});
          });
          beams.fetch_add(cast, std::memory_order_relaxed);
        });
      });
    }
  });
  beams_ += beams;
}

void Tick::actuate() {
  Actuation::Faulty faulty = BodyId().value;
  const auto actuate_rows = [&](std::span<const Row> rows, const BodyType& type) {
    if (type.drive)
      for_due(state_, rows, type.drive->period,
              [&](std::span<const Row> some) { actuation_.drive(some, *type.drive, faulty); });
    if (type.drive && type.drive->supply) actuation_.halt_spent(rows, *type.drive);
    for (const BodyType::Device& device : type.devices) {
      if (device.kind->halt && (device.supply || state_.now.impaired > 0))
        actuation_.halt_stopped(rows, device);
      if (device.kind->act)
        for_running(state_, rows, device, [&](std::span<const Row> running) {
          for_seeing(running, type, device, [&](std::span<const Row> some) {
            call_kind(state_.view, some, device, [&] { device.kind->act(device_batch(some, type, device)); });
          });
        });
    }
  };
  for_blocks(state_, parallel_, ranks_->own(state_.row_count()),
             [&](std::span<const Row> rows, const BodyType& type) {
               if (state_.now.impaired > 0) actuation_.halt_disabled(rows, type);
               for_enabled(state_, rows, [&](std::span<const Row> enabled) { actuate_rows(enabled, type); });
             });
  if (const BodyId id(faulty.load()); id.valid()) actuation_.throw_faulty(id);
  check_effects();
}

/// Throws StepError if a device has emitted an effect that it must not emit. Kinds of plug-ins may do so.
void Tick::check_effects() {
  const auto is_wrong = [this](const Effect& effect) { return !check(state_, effect); };
  if (std::ranges::none_of(effects_.emitted(), is_wrong)) return check_order(state_.view, effects_.sorted());
  const Effect& effect = *std::ranges::find_if(effects_.sorted(), is_wrong);
  throw_effect_error(state_.view, effect, check(state_, effect).error().text);
}

void Tick::decide() {
  for_blocks(state_, parallel_, ranks_->own(state_.row_count()),
             [&](std::span<const Row> present, const BodyType& type) {
               if (type.controllers.empty()) return;
               for_enabled(state_, present, [&](std::span<const Row> rows) {
                 for (const BodyType::Controller& controller : type.controllers)
                   if (!controller.kind->is_collective)
                     for_due(state_, rows, controller.period,
                             [&](std::span<const Row> some) { decide(some, type, controller); });
               });
             });
  if (!has_collective_) return;
  ranks_->on_rank_0([this] { decide_together(); });
}

/// Calls each controller with ControllerKind::is_collective once, for all its robots that are due in this
/// tick, in the order of their ids.
void Tick::decide_together() {
  const auto is_collective = [](const BodyType::Controller& controller) {
    return controller.kind->is_collective;
  };
  const auto type_of = [this](Row row) { return state_.row_types[row.index()]; };
  const auto type_and_id = [&](Row row) { return std::pair(type_of(row), state_.ids[row.index()]); };
  // First, one pass over the bodies lists the robots of all types, because each robot may have its own type.
  std::vector<Row>& rows = deciding_;
  rows.clear();
  for (std::size_t b = 0; b < state_.rows.size(); ++b) {
    if (state_.view.location(BodyId(b)) != RowLocation::here) continue;
    const Row row = state_.view.row(BodyId(b));
    if (state_.view.is_there(row) && !state_.view.is_disabled(row) &&
        std::ranges::any_of(state_.type(row).controllers, is_collective))
      rows.push_back(row);
  }
  if (!std::ranges::is_sorted(rows, {}, type_and_id)) std::ranges::sort(rows, {}, type_and_id);
  const std::size_t all = rows.size();
  for (std::size_t first = 0, end = 0; first < all; first = end) {
    const BodyType& type = state_.type(rows[first]);
    while (end < all && type_of(rows[end]) == type_of(rows[first])) ++end;
    for (const BodyType::Controller& controller : type.controllers) {
      if (!is_collective(controller)) continue;
      rows.resize(all);  // removes the list of the controller before
      for (std::size_t i = first; i < end; ++i)
        if ((state_.now.tick - state_.view.birth_tick(rows[i])) % controller.period == 0)
          rows.push_back(rows[i]);
      if (rows.size() > all) decide(std::span(rows).subspan(all), type, controller);
    }
  }
}

DeviceBatch Tick::device_batch(std::span<const Row> rows, const BodyType& type,
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

void Tick::decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller) {
  DecideBatch batch{.tick = state_.now.tick,
                    .time_s = state_.view.time_s(),
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
                    .estimates = state_.view.estimates(type)};
  const auto rows_of = [this](std::size_t table) {
    return DecideBatch::Rows{state_.tables[table].row(0), state_.tables[table].row_bytes()};
  };
  for (const std::size_t sensor : controller.devices) {
    const BodyType::Device& chosen = type.devices[sensor];
    batch.percepts[batch.devices] = &state_.view.percepts(chosen);
    batch.switches[batch.devices] = chosen.switch_bit;
    batch.device_commands[batch.devices++] =
        chosen.command_table ? rows_of(*chosen.command_table) : DecideBatch::Rows();
  }
  if (controller.table) batch.memories = rows_of(*controller.table);
  if (controller.drive) {
    const BodyType::Device& drive = type.devices[*controller.drive];
    batch.drive_commands = rows_of(*drive.command_table);
    batch.drive_state = &state_.view.percepts(drive);
  }
  call_kind(state_.view, rows, controller, [&] {
    if (on_decide_)
      on_decide_(type, controller, batch);
    else
      controller.kind->decide(controller.data, batch);
  });
}

void Tick::move() {
  Ranks::Border* const border = ranks_->border();
  movement_.propose();
  movement_.resolve(links_.composites(), border);
  conflict_rounds_ += movement_.rounds();
  if (has_collisions_) report_collisions();
  movement_.commit();
  if (links_.any()) {
    links_.resolve_joints(movement_.longest(), border);
    links_.carry();
  }
  ranks_->report_joints([this] { report_joints(); });
  apply_effects();
}

/// Calls the hook collide of the devices of the own rows whose body ran into another one in this tick, or was
/// run into: for each body in the order of the ids of the movers. The bodies are still at their old poses.
void Tick::report_collisions() {
  if (Ranks::Border* const border = ranks_->border()) border->exchange_blocks(movement_.blocks());
  felt_.clear();
  const std::span<const Conflicts::Block> blocks = movement_.blocks();
  for (std::uint32_t r = 0; r < blocks.size(); ++r) {
    if (blocks[r].sample == 0) continue;
    add_feelers(Row(r), r);
    const BodyId other = blocks[r].contact.blocker();
    if (state_.view.location(other) == RowLocation::here) add_feelers(state_.view.row(other), r);
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
        const Row blocker = state_.view.location(other) == RowLocation::here ? state_.view.row(other) : Row();
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
void Tick::add_feelers(Row root, std::uint32_t mover) {
  const RowRange own = ranks_->own(state_.row_count());
  const auto add = [&](Row row) {
    if (own.first <= row.index() && row.index() < own.end && !state_.type(row).collision_devices.empty())
      felt_.push_back({row, mover, root.value == mover});
  };
  add(root);
  if (state_.now.carried == 0 || !links_.any()) return;
  cargo_.clear();
  links_.add_cargo(root, cargo_);
  std::ranges::for_each(cargo_, add);
}

void Tick::apply_effects() {
  if (effects_.empty()) return;
  const std::span<const Effect> effects = effects_.sorted();
  const auto device_of = [this](const Effect& effect) -> const BodyType::Device& {
    return state_.type(state_.view.row(effect.source)).devices[effect.device];
  };
  const auto apply = [&](const Effect& effect) {
    if (effect.is_of_life()) return;
    const BodyType::Device& device = device_of(effect);
    const Row source = state_.view.row(effect.source);
    call_kind(state_.view, {&source, 1}, device, [&] {
      if (blinkers_) blinkers_->begin_effect(effect);
      device.kind->apply(EffectContext(state_, links_, effect), device.prepared.data, effect);
      if (blinkers_) blinkers_->end_effect(device, effect);
    });
  };
  ranks_->apply_effects(effects, std::ref(apply));
  const auto born = [&](const Effect& effect, const Birth& birth) {
    const BodyType::Device& device = device_of(effect);
    if (!device.kind->born) return;
    const Row source = state_.view.row(effect.source);
    call_kind(state_.view, {&source, 1}, device, [&] {
      device.kind->born(EffectContext(state_, links_, effect), device.prepared.data, effect, birth);
    });
  };
  if (std::ranges::any_of(effects, &Effect::is_of_life)) lives_.resolve(effects, std::ref(born));
  effects_.clear();
}

/// Calls the hook joints_moved of devices, which reads the outcomes of the joint motions that the devices
/// have requested in this tick. Then clears these outcomes. Does nothing if no device has requested a joint
/// motion.
void Tick::report_joints() {
  if (!links_.take_asked()) return;
  for_blocks(state_, parallel_, [&](std::span<const Row> rows, const BodyType& type) {
    if (type.joint_devices.empty()) return;
    for (const std::size_t d : type.joint_devices) {
      const BodyType::Device& device = type.devices[d];
      if (device.kind->joints_moved)
        call_kind(state_.view, rows, device,
                  [&] { device.kind->joints_moved(device_batch(rows, type, device)); });
    }
    for (const Row row : rows) links_.clear_goals(row);
  });
}

}  // namespace troupe::engine
