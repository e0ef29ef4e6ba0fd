#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"
#include "sensors/light_source.hpp"

namespace troupe::models {

/// The command of a light, which is a device of the kind `blinkenlight` (it blinks) or `lightindicator` (it
/// is dark by default). The command holds until the controller replaces it.
struct LightCommand {
  /// How the light is switched.
  enum Switch : std::uint8_t {
    as_world_says,  ///< a blinkenlight is lit as its parameters say; a lightindicator is dark
    on,             ///< lit, without blinking
    off,            ///< dark
  };
  std::uint8_t state = as_world_says;  ///< how the light is switched, a Switch

  static constexpr void describe(engine::Description<LightCommand>& d) {
    d.member<&LightCommand::state>(
        "state", "0: a blinkenlight is lit as its parameters say, a lightindicator is dark; 1: lit; 2: dark");
  }
};

using sensors::LightState;

/// Returns the definition of the device `blinkenlight`, a light that blinks: in each `period`, the light is
/// first lit for the fraction `dutycycle` of the period, and then dark. The first period begins at the start
/// of the run (tick 0).
///
/// parameters  period (s), dutycycle (0 to 1), enabled, intensity (reading of a light sensor 1 m away)
/// state       LightState; commands: LightCommand, whose `on` and `off` override the blinking
/// edges       If `enabled` is false, the light is dark until a controller switches it on. With a period of
///             0, the light does not blink: it is lit unless the dutycycle is 0. At the instant at which the
///             lit part of a period ends, the light is dark.
/// errors      The light must be inside the smallest circle that is centred at the origin of its body and
///             encloses the body; otherwise the world is invalid. The reason: light sensors search for lights
///             only within these circles.
engine::DeviceKind blinkenlight_kind();

/// Returns the definition of the device `lightindicator`, a light that is dark until a controller switches it
/// on (parameter: intensity; state: LightState; commands: LightCommand). As for a blinkenlight, the light
/// must be inside the smallest circle that is centred at the origin of its body and encloses the body.
engine::DeviceKind lightindicator_kind();

}  // namespace troupe::models
