#include "models/devices/light.hpp"

#include "engine/fields/description.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <cmath>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using sensors::LightSource;

/// Whether the light is lit at `time_s` (s) if no controller has switched it.
bool is_lit(const LightSource& light, double time_s) {
  if (!light.enabled) return false;
  if (light.period_s == 0) return light.dutycycle > 0;
  const double cycles = time_s / light.period_s;
  return cycles - std::floor(cycles) < light.dutycycle;
}

/// Makes a kind of light with the parameters `Params`. Params::source() converts them to a LightSource, which
/// is the data of each light of this kind. Light sensors recognise lights by data of this type.
template <class Params>
DeviceKind make_light(std::string_view name, std::string_view text) {
  DeviceKind kind{.name = name, .text = text, .params = engine::described<Params>()};
  kind.prepare = [](const engine::Record& record, const Pose& pose_body_light) {
    return DeviceKind::Prepared{.data = engine::from_record<Params>(record).source(pose_body_light),
                                .percepts = engine::memory_fields<LightState>(),
                                .percept_bytes = sizeof(LightState),
                                .commands = engine::memory_fields<LightCommand>(),
                                .command_bytes = sizeof(LightCommand)};
  };
  kind.act = [](const DeviceBatch& batch) {
    const LightSource& light = *std::any_cast<LightSource>(&batch.data);
    const bool by_itself = is_lit(light, batch.view.time_s());
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const auto& command = batch.commands->as<LightCommand>(batch.slot(i));
      const bool lit =
          command.state == LightCommand::as_world_says ? by_itself : command.state == LightCommand::on;
      batch.state.as<LightState>(batch.slot(i)).lit = lit;
    }
  };
  return kind;
}

struct IndicatorParams {
  double intensity = 1;

  static constexpr void describe(engine::Description<IndicatorParams>& d) {
    d.member<&IndicatorParams::intensity>(
        "intensity", engine::facts::within(0, 1e6),
        "brightness that a light sensor reads when it faces the light at a distance of 1 m");
  }
  LightSource source(const Pose& pose_body_light) const {
    return {.pose_body_light = pose_body_light, .intensity = intensity};
  }
};

struct BlinkenParams {
  double period = 1;
  double dutycycle = 1;
  bool enabled = true;
  IndicatorParams light;

  static constexpr void describe(engine::Description<BlinkenParams>& d) {
    using namespace engine::facts;
    d.member<&BlinkenParams::period>(
        "period", engine::Unit::seconds, within(0, 1e6),
        "time from the start of one flash to the start of the next; 0: the light does not blink");
    d.member<&BlinkenParams::dutycycle>("dutycycle", within(0, 1),
                                        "fraction of each period in which the light is lit");
    d.member<&BlinkenParams::enabled>("enabled",
                                      "true: the light is lit as `period` and `dutycycle` say; false: it is "
                                      "dark. Commands of a controller override this parameter");
    d.part<&BlinkenParams::light>();
  }
  LightSource source(const Pose& pose_body_light) const {
    return {pose_body_light, light.intensity, period, dutycycle, enabled};
  }
};

}  // namespace

DeviceKind blinkenlight_kind() { return make_light<BlinkenParams>("blinkenlight", "a light that blinks"); }

DeviceKind lightindicator_kind() {
  return make_light<IndicatorParams>("lightindicator", "a light that controllers switch");
}

}  // namespace troupe::models
