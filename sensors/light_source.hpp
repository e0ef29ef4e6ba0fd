#pragma once

#include "base/pose.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <any>
#include <cstdint>
#include <string_view>

namespace troupe::sensors {

/// Name of the first field of the state of a light, LightState::lit.
inline constexpr std::string_view k_lit = "lit";

/// The state of a light. LightSource explains which devices are lights. A light that does not run, for
/// example because its power supply is empty, keeps its state: it stays lit or dark.
struct LightState {
  std::uint8_t lit = 0;  ///< 1 if the light is lit in this tick (time step), else 0

  static constexpr void describe(engine::Description<LightState>& d) {
    d.member<&LightState::lit>(k_lit, engine::facts::is_appearance, "1: the light is lit in this tick");
  }
};

/// The properties of a light. A device is a light if it stores a LightSource as its prepared data
/// (engine::DeviceKind::Prepared::data), whatever its kind. Prepared data is what a device computes from its
/// parameters when a world is loaded. `period_s`, `dutycycle` and `enabled` determine when the light is lit.
/// A command of a controller overrides them.
struct LightSource {
  /// Pose in the frame of the body or joint that carries the light, m and rad. The heading has no effect:
  /// lights shine in all directions. The position must be inside the circle about the body's origin that
  /// encloses the body (engine::solids_radius()). Reason: light sensors look for lights only inside such
  /// circles.
  Pose pose_body_light;
  /// Reading (no unit) of a light sensor that faces the lit light at a distance of 1 m.
  double intensity = 1;
  double period_s = 0;   ///< time from the start of one flash to the next, s; 0: the light does not blink
  double dutycycle = 0;  ///< lit fraction of each period, 0 to 1; with period_s 0: above 0 means always lit
  bool enabled = false;  ///< false: the light is dark until a controller switches it on
};

/// Returns the properties of a device that is a light; null if the device is not a light. The pointer is
/// valid as long as `device` exists.
inline const LightSource* light_source(const engine::DeviceKind::Prepared& device) {
  return std::any_cast<LightSource>(&device.data);
}

}  // namespace troupe::sensors
