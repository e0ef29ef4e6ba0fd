#include "models/devices/light.hpp"

#include "engine/world.hpp"

#include <cmath>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Record;
using engine::Unit;
using sensors::LightSource;

/// Whether the light is on at `time_s` (s) if no controller has switched it.
bool is_lit(const LightSource& light, double time_s) {
  if (!light.enabled) return false;
  if (light.period_s == 0) return light.dutycycle > 0;
  const double cycles = time_s / light.period_s;
  return cycles - std::floor(cycles) < light.dutycycle;
}

DeviceKind::Prepared prepare(const LightSource& light) {
  std::vector<engine::StateField> state = engine::memory_fields<LightState>();
  state.front().look = true;
  return {.data = light,
          .percepts = std::move(state),
          .percept_bytes = sizeof(LightState),
          .commands = engine::memory_fields<LightCommand>(),
          .command_bytes = sizeof(LightCommand)};
}

void act(const DeviceBatch& batch) {
  const LightSource& light = *std::any_cast<LightSource>(&batch.data);
  const bool by_itself = is_lit(light, batch.world.time_s());
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const auto& command = batch.commands->as<LightCommand>(batch.slot(i));
    const bool lit =
        command.state == LightCommand::as_world_says ? by_itself : command.state == LightCommand::on;
    batch.state.as<LightState>(batch.slot(i)).lit = lit;
  }
}

engine::Field intensity_field() {
  return {.name = "intensity",
          .fallback = 1.0,
          .min = 0,
          .max = 1e6,
          .text = "what a light sensor reads that faces it from 1 m"};
}

}  // namespace

DeviceKind blinkenlight_kind() {
  DeviceKind kind{.name = "blinkenlight", .text = "a light that blinks"};
  kind.params = {{
      {.name = "period",
       .unit = Unit::seconds,
       .fallback = 1.0,
       .min = 0,
       .max = 1e6,
       .text = "from one flash to the next; 0: it shines all the time"},
      {.name = "dutycycle",
       .fallback = 1.0,
       .min = 0,
       .max = 1,
       .text = "the share of each period for which it is lit"},
      {.name = "enabled",
       .type = FieldType::boolean,
       .fallback = true,
       .text = "whether it blinks before a controller switches it"},
      intensity_field(),
  }};
  kind.prepare = [](const Record& params, const Pose& pose_body_light) {
    return prepare(
        {pose_body_light, params[3].number(), params[0].number(), params[1].number(), params[2].boolean()});
  };
  kind.act = act;
  return kind;
}

DeviceKind lightindicator_kind() {
  DeviceKind kind{.name = "lightindicator", .text = "a light that controllers switch"};
  kind.params = {{intensity_field()}};
  kind.prepare = [](const Record& params, const Pose& pose_body_light) {
    return prepare({.pose_body_light = pose_body_light, .intensity = params[0].number()});
  };
  kind.act = act;
  return kind;
}

}  // namespace troupe::models
