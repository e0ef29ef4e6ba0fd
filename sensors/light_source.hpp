#pragma once

#include "base/pose.hpp"
#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <any>
#include <cstdint>

namespace troupe::sensors {

/// What a light shows: the state of a device whose prepared data are a LightSource.
struct LightState {
  std::uint8_t lit = 0;  ///< 1: it shines in this tick

  static constexpr void describe(engine::Description<LightState>& d) {
    d.member<&LightState::lit>("lit", engine::facts::is_look);
  }
};

/// What a kind of light prepares (engine::DeviceKind::Prepared::data): a light sensor knows lights by it.
struct LightSource {
  /// Frame of its body or of its joint. Its heading means nothing: lights shine all round.
  Pose pose_body_light;
  double intensity = 1;  ///< what a sensor that faces it reads at 1 m while it is lit
  double period_s = 0;   ///< from one flash to the next; 0: it shines all the time
  double dutycycle = 0;  ///< the share of each period for which it is lit
  bool enabled = false;  ///< whether it blinks before a controller switches it
};

/// Of a device; null where it is no light.
inline const LightSource* light_source(const engine::DeviceKind::Prepared& device) {
  return std::any_cast<LightSource>(&device.data);
}

}  // namespace troupe::sensors
