#include "models/light.hpp"

#include "engine/world.hpp"

#include <cmath>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Record;
using engine::Unit;

struct Blinking {
  LightSource source;
  double period_s = 0;
  double dutycycle = 0;
  bool enabled = false;

  /// Whether it is lit at this time, s, where nobody has switched it.
  bool lit(double time_s) const {
    if (!enabled) return false;
    if (period_s == 0) return dutycycle > 0;
    const double cycles = time_s / period_s;
    return cycles - std::floor(cycles) < dutycycle;
  }
};

DeviceKind::Prepared prepare(const Blinking& blinking) {
  std::vector<engine::StateField> state = engine::memory_fields<LightState>();
  state.front().look = true;
  return {.data = blinking,
          .percepts = std::move(state),
          .percept_bytes = sizeof(LightState),
          .commands = engine::memory_fields<LightCommand>(),
          .command_bytes = sizeof(LightCommand)};
}

void act(const DeviceBatch& batch) {
  const Blinking& blinking = *std::any_cast<Blinking>(&batch.data);
  const bool by_itself = blinking.lit(batch.world.time_s());
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

constexpr std::string_view k_blinkenlight = "blinkenlight";
constexpr std::string_view k_lightindicator = "lightindicator";

}  // namespace

const LightSource& light_source(const std::any& data) { return std::any_cast<const Blinking&>(data).source; }

bool is_light(const DeviceKind& kind) { return kind.name == k_blinkenlight || kind.name == k_lightindicator; }

DeviceKind blinkenlight_kind() {
  DeviceKind kind{.name = k_blinkenlight, .text = "a light that blinks"};
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
    return prepare(Blinking{
        {pose_body_light, params[3].number()}, params[0].number(), params[1].number(), params[2].boolean()});
  };
  kind.act = act;
  return kind;
}

DeviceKind lightindicator_kind() {
  DeviceKind kind{.name = k_lightindicator, .text = "a light that controllers switch"};
  kind.params = {{intensity_field()}};
  kind.prepare = [](const Record& params, const Pose& pose_body_light) {
    return prepare(Blinking{.source = {pose_body_light, params[0].number()}});
  };
  kind.act = act;
  return kind;
}

}  // namespace troupe::models
