#include "models/devices/light.hpp"

#include "engine/fields/description.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using sensors::LightSource;

/// Whether the light is lit at `time_s` (s) if no controller has switched it.
bool is_lit(const LightSource& light, double time_s) {
  if (!light.enabled) return false;
  if (light.period_s == 0 || light.dutycycle <= 0 || light.dutycycle >= 1) return light.dutycycle > 0;
  const double cycles = time_s / light.period_s;
  // A tolerance as in ticks_until(): rounding must not shift the start or the end of a flash by a tick.
  const double slack = 1e-9 * std::max(1.0, cycles);
  return cycles - std::floor(cycles + slack) < light.dutycycle - slack;
}

/// Checks that the light is inside the circle about the origin of its body that encloses the body, because
/// light sensors find lights by the circles of bodies.
Result<> check_place(const LightSource& light, const engine::TypeSpec& type) {
  constexpr double k_rounding = 1 + 1e-9;  // a light on the rim may be outside by rounding
  const double distance = light.pose_body_light.position().norm();
  const double radius = engine::solids_radius(type);
  if (distance <= radius * k_rounding) return {};
  return Error{
      fmt::format("is {:g} m from the origin of its body; it must be within {:g} m, the radius of the body",
                  distance, radius)};
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
  kind.bind_part = [](std::any& data, const engine::TypeSpec& type, std::uint32_t) {
    return check_place(*std::any_cast<LightSource>(&data), type);
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
