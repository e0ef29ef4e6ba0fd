#include "engine/world.hpp"
#include "models/devices/power.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Record;
using engine::Unit;

// To itself, while it is charged: whether that goes on. Controllers read of the last tick after act() has
// run, so `charging` changes only with the transfers, which come before this or behind it.
constexpr std::uint32_t k_ask_whether_charging = 0;

constexpr double k_watts_per_kg = 10;  // and m/s or rad/s: Stage's position model

struct Pack {
  double capacity = 0;
  double stored = 0;
  bool infinite = false;
  double draw = 0;
  double mass = 0;
  double idle = 0;
  bool stops = true;
  bool kills = false;
};

std::vector<engine::StateField> state_fields() {
  std::vector<engine::StateField> fields = engine::memory_fields<PowerPackState>();
  constexpr std::string_view texts[] = {"what it holds",
                                        "what it can hold",
                                        "by all that runs on it, since tick 0",
                                        "from others, by contact, since tick 0",
                                        "to others, by contact, since tick 0",
                                        "1: it never runs out",
                                        "1: it was given something in the last tick"};
  static_assert(std::size(texts) == 7);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    if (fields[f].element == engine::Element::f64) fields[f].unit = std::string("J");
    fields[f].text = texts[f];
  }
  return fields;
}

/// W: what the drive of a row draws.
double drive_watts(const Pack& pack, const engine::Velocity& v) {
  return pack.idle + k_watts_per_kg * pack.mass * (std::abs(v.x) + std::abs(v.y) + std::abs(v.turn));
}

void act(const DeviceBatch& batch) {
  const Pack& pack = *std::any_cast<Pack>(&batch.data);
  const BodyType& type = batch.world.type(batch.rows.front());
  const auto feeds = [&batch](std::optional<std::size_t> supply) { return supply == batch.device; };
  const bool feeds_drive = type.drive && feeds(type.drive->supply);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const Row row = batch.rows[i];
    auto& state = batch.state.as<PowerPackState>(batch.slot(i));
    if (state.charging != 0) batch.emit(i, 0, k_ask_whether_charging, batch.body(i), {state.received});
    if (pack.kills && state.is_empty()) batch.emit_death(i, 1, batch.body(i));
    double watts = pack.draw;
    if (feeds_drive) watts += drive_watts(pack, batch.world.velocities()[row.index()]);
    for (const BodyType::Device& device : type.devices)
      if (feeds(device.supply) && batch.world.senses(row, device) && batch.world.is_on(row, device))
        watts += device.prepared.watts;
    double joules = watts * batch.period_s;
    if (!pack.infinite) {
      joules = std::min(joules, state.stored);
      state.stored -= joules;
    }
    state.dissipated += joules;
  }
}

void apply(engine::World& world, const std::any&, const engine::Effect& effect) {
  const Row row = world.row(effect.source);
  auto& state = world.state(world.type(row).devices[effect.device]).as<PowerPackState>(world.slot(row));
  state.charging = state.received > effect.payload[0];
}

}  // namespace

DeviceKind power_pack_kind() {
  constexpr double k_most_joules = 1e12;
  constexpr double k_most_watts = 1e9;
  DeviceKind kind{.name = "power_pack", .text = "what the part that carries it, and those on it, run on"};
  kind.params = {{
      {.name = "capacity",
       .unit = Unit::joules,
       .fallback = 0.0,
       .min = 0,
       .max = k_most_joules,
       .text = "what it can hold"},
      {.name = "stored",
       .unit = Unit::joules,
       .fallback = k_most_joules,
       .min = 0,
       .max = k_most_joules,
       .text = "what it holds at the start; no more than its capacity, and that unless given"},
      {.name = "infinite",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "it never runs out, nor is ever charged"},
      {.name = "draw",
       .unit = Unit::watts,
       .fallback = 0.0,
       .min = 0,
       .max = k_most_watts,
       .text = "what the body draws all the time, beside its drive and devices"},
      {.name = "mass",
       .unit = Unit::kilograms,
       .fallback = 0.0,
       .min = 0,
       .max = 1e6,
       .text = "of what the drive moves: 10 W for each kg and m/s or rad/s"},
      {.name = "idle",
       .unit = Unit::watts,
       .fallback = 1.0,
       .min = 0,
       .max = k_most_watts,
       .text = "what the drive draws at rest"},
      {.name = "when_empty",
       .type = FieldType::text,
       .fallback = "stop",
       .text =
           "whether an empty pack stops what runs on it, or nothing comes of it, as in Stage, or its body "
           "dies, docs/lives.md",
       .choices = {"stop", "nothing", "die"}},
  }};
  kind.prepare = [](const Record& params, const Pose&) {
    const double capacity = params[0].number();
    const Pack pack{.capacity = capacity,
                    .stored = std::min(params[1].number(), capacity),
                    .infinite = params[2].boolean(),
                    .draw = params[3].number(),
                    .mass = params[4].number(),
                    .idle = params[5].number(),
                    .stops = params[6].text() != "nothing",
                    .kills = params[6].text() == "die"};
    return DeviceKind::Prepared{.data = pack,
                                .percepts = state_fields(),
                                .percept_bytes = sizeof(PowerPackState),
                                .most_effects = pack.kills ? std::size_t{2} : 1,
                                .ends_lives = pack.kills};
  };
  kind.start = [](const std::any& data, engine::StateTable& state, std::size_t slot) {
    const Pack& pack = *std::any_cast<Pack>(&data);
    auto& row = state.as<PowerPackState>(slot);
    row.infinite = pack.infinite;
    if (pack.infinite) return;
    row.capacity = pack.capacity;
    row.stored = pack.stored;
  };
  kind.act = act;
  kind.apply = apply;
  kind.energy = [](const engine::StateTable& rows, std::size_t slot) {
    const auto& state = rows.as<PowerPackState>(slot);
    return engine::Energy{state.stored, state.capacity,      state.dissipated,   state.received,
                          state.given,  state.infinite != 0, state.charging != 0};
  };
  kind.is_spent = [](const std::any& data, const engine::StateTable& state, std::size_t slot) {
    return std::any_cast<Pack>(&data)->stops && state.as<PowerPackState>(slot).is_empty();
  };
  return kind;
}

}  // namespace troupe::models
