#pragma once

#include "base/pose.hpp"
#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <any>
#include <cstdint>

namespace troupe::sensors {

/// The state of a light. A device is a light if its prepared data is a LightSource.
struct LightState {
  std::uint8_t lit = 0;  ///< 1 if the light is lit in this tick

  static constexpr void describe(engine::Description<LightState>& d) {
    d.member<&LightState::lit>("lit", engine::facts::is_appearance);
  }
};

/// The prepared data (engine::DeviceKind::Prepared::data) of a light. Light sensors find lights by this type.
struct LightSource {
  /// Pose in the frame of its body or joint. Its heading has no effect: lights shine in all directions.
  Pose pose_body_light;
  double intensity = 1;  ///< reading of a light sensor that faces the lit light from 1 m
  double period_s = 0;   ///< time from one flash to the next; 0: always lit
  double dutycycle = 0;  ///< fraction of each period for which it is lit
  bool enabled = false;  ///< whether it blinks until a controller switches it on or off
};

/// The light that a device is; null if the device is not a light.
inline const LightSource* light_source(const engine::DeviceKind::Prepared& device) {
  return std::any_cast<LightSource>(&device.data);
}

}  // namespace troupe::sensors
