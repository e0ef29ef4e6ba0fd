#include "models/devices/spawner.hpp"

#include "base/math.hpp"
#include "engine/ticks.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace troupe::models {
namespace {

using engine::BirthStatus;
using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Mount;
using engine::Record;
using engine::Unit;
using engine::World;

struct Spawner {
  std::string population;
  std::uint32_t reserve = 0;  // index into the world's
  double every_s = 0;
  std::uint64_t per_flags = 0;
  double within_m = 0;
  Mount mount;  // its frame in the body's
};

/// How many whole periods of its life end within the ticks since it last ran.
std::uint64_t periods_ended(const World& world, Row row, std::uint64_t own_period, double every_s) {
  const std::uint64_t age = world.tick() - world.birth_tick(row);
  const std::uint64_t every = engine::period_ticks(every_s, world.tick_s());
  return age / every - (age - std::min(age, own_period)) / every;
}

/// Flags that others gave to the row's body since its life began.
std::uint64_t flags_received(const World& world, Row row) {
  std::uint64_t sum = 0;
  for (const BodyType::Device& device : world.type(row).devices)
    if (device.kind->flags) sum += device.kind->flags(world.percepts(device), world.slot(row)).received;
  return sum;
}

Pose place(const DeviceBatch& batch, std::size_t i, const Spawner& spawner) {
  const Mount frame = compose(batch.mount(i), spawner.mount);
  if (!(spawner.within_m > 0)) return frame.pose();
  Random random = batch.random(i);
  const double radius = spawner.within_m * sqrt(random.uniform());
  const SinCos at = sincos(random.uniform(-k_pi, k_pi));
  const Pose drawn{radius * at.cos, radius * at.sin, 0, random.uniform(-k_pi, k_pi)};
  return compose(frame, Mount(drawn)).pose();
}

void act(const DeviceBatch& batch) {
  const Spawner& spawner = *std::any_cast<Spawner>(&batch.data);
  const World& world = batch.world;
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const Row row = batch.rows[i];
    auto& state = batch.state.as<SpawnerState>(batch.slot(i));
    const std::uint32_t request = batch.commands->as<SpawnerCommand>(batch.slot(i)).request;
    std::uint64_t due = request - state.request;
    state.request = request;
    if (spawner.every_s > 0)
      due += periods_ended(world, row, world.type(row).devices[batch.device].period, spawner.every_s);
    if (spawner.per_flags > 0) {
      const std::uint64_t received = flags_received(world, row);
      due += received / spawner.per_flags - state.flags / spawner.per_flags;
      state.flags = received;
    }
    const bool is_over = state.status == static_cast<std::uint8_t>(BirthStatus::used_up);
    state.owed = is_over ? 0 : state.owed + static_cast<std::uint32_t>(due);
    if (state.owed > 0) batch.emit_birth(i, 0, spawner.reserve, place(batch, i, spawner));
  }
}

void born(World& world, const std::any&, const engine::Effect& effect, const engine::Birth& birth) {
  const Row row = world.row(effect.source);
  const BodyType::Device& device = world.type(row).devices[effect.device];
  auto& state = world.state(device).as<SpawnerState>(world.slot(row));
  state.status = static_cast<std::uint8_t>(birth.status);
  switch (birth.status) {
    case BirthStatus::born:
      ++state.born;
      --state.owed;
      state.last = birth.body.value + 1;
      break;
    case BirthStatus::occupied: ++state.refused; break;
    case BirthStatus::used_up: state.owed = 0; break;
    case BirthStatus::unasked: break;
  }
}

Result<> mount(std::any& data, const engine::TypeSpec& type, std::uint32_t) {
  if (std::any_cast<Spawner>(&data)->per_flags == 0) return {};
  const bool has_flags = std::ranges::any_of(
      type.devices, [](const engine::DeviceSpec& device) { return device.kind == "flags"; });
  if (has_flags) return {};
  return Error{"counts flags, and its body has no device \"flags\" that others could give them to"};
}

Result<> look(std::any& data, const engine::WorldSpec& world) {
  auto& spawner = *std::any_cast<Spawner>(&data);
  const auto found = std::ranges::find(world.reserves, spawner.population, &engine::ReserveSpec::population);
  if (found != world.reserves.end()) {
    spawner.reserve = static_cast<std::uint32_t>(found - world.reserves.begin());
    return {};
  }
  std::vector<std::string_view> known;
  for (const engine::ReserveSpec& reserve : world.reserves) known.push_back(reserve.population);
  if (known.empty())
    return Error{
        fmt::format("bears \"{}\", and no population of this world has a \"reserve\"", spawner.population)};
  return Error{fmt::format("bears {}", unknown_name("population with a reserve", spawner.population, known))};
}

}  // namespace

DeviceKind spawner_kind() {
  DeviceKind kind{.name = "spawner", .text = "bears bodies of a population's reserve"};
  kind.params = {{
      {.name = "population",
       .type = FieldType::text,
       .fallback = "",
       .text = "of which bodies are born: one with a reserve"},
      {.name = "every",
       .unit = Unit::seconds,
       .fallback = 0.0,
       .min = 0,
       .max = 1e9,
       .text = "from one birth to the next; 0: none by itself"},
      {.name = "per_flags",
       .type = FieldType::integer,
       .fallback = 0,
       .min = 0,
       .max = 1e9,
       .text = "a birth for each so many flags that others give to its body; 0: for none"},
      {.name = "within",
       .unit = Unit::meters,
       .fallback = 0.0,
       .min = 0,
       .max = 1000,
       .text = "radius of the circle in which they are born, anywhere and heading anywhere; 0: at its own "
               "pose"},
  }};
  kind.prepare = [](const Record& params, const Pose& pose_body_spawner) {
    const Spawner spawner{.population = params[0].text(),
                          .reserve = 0,
                          .every_s = params[1].number(),
                          .per_flags = static_cast<std::uint64_t>(params[2].integer()),
                          .within_m = params[3].number(),
                          .mount = Mount(pose_body_spawner)};
    return DeviceKind::Prepared{.data = spawner,
                                .percepts = engine::memory_fields<SpawnerState>(),
                                .percept_bytes = sizeof(SpawnerState),
                                .commands = engine::memory_fields<SpawnerCommand>(),
                                .command_bytes = sizeof(SpawnerCommand),
                                .most_effects = 1};
  };
  kind.mount = mount;
  kind.look = look;
  kind.act = act;
  kind.born = born;
  return kind;
}

}  // namespace troupe::models
