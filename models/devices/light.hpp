#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"
#include "sensors/light_source.hpp"

namespace troupe::models {

/// The command of a light: of a `blinkenlight`, which blinks, or of a `lightindicator`, which is dark until a
/// controller switches it on. The command holds until the controller replaces it.
struct LightCommand {
  /// The state to which the light is switched.
  enum Switch : std::uint8_t {
    as_world_says,  ///< a blinkenlight blinks as its parameters say; a lightindicator is dark
    on,             ///< lit, without blinking
    off,            ///< dark
  };
  std::uint8_t state = as_world_says;  ///< one of Switch

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
/// parameters  period (s), dutycycle (0 to 1), enabled (false: the light is dark until a controller switches
///             it on), intensity (reading of a light sensor that faces the light from a distance of 1 m)
/// state       LightState; commands: LightCommand, whose `on` and `off` override the blinking
/// edges       With a period of 0, the light does not blink: it is always lit if the dutycycle is above 0,
///             and always dark if it is 0.
/// errors      The light must be inside the circle that encloses its body: the smallest such circle whose
///             centre is the origin of the body. Otherwise the world is invalid, because light sensors search
///             for lights only in these circles.
engine::DeviceKind blinkenlight_kind();

/// Returns the definition of the device `lightindicator`, a light that is dark until a controller switches it
/// on. As for a blinkenlight, the light must be inside the smallest circle that is centred at the origin of
/// its body and encloses the body.
///
/// parameters  intensity (reading of a light sensor that faces the light from a distance of 1 m)
/// state       LightState; commands: LightCommand
engine::DeviceKind lightindicator_kind();

}  // namespace troupe::models
