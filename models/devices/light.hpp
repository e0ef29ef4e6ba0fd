#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"
#include "sensors/light_source.hpp"

namespace troupe::models {

/// What controllers ask of a light; it stays so until they ask otherwise.
struct LightCommand {
  /// What overrides the blinking.
  enum Switch : std::uint8_t {
    as_world_says,  ///< as its parameters have it
    on,             ///< it shines, and does not blink
    off,            ///< it is dark
  };
  std::uint8_t state = as_world_says;  ///< a Switch
  TROUPE_FIELDS(state)
};

using sensors::LightState;

/// A light that blinks: lit for the first `dutycycle` of each `period`, from tick 0 on.
///
/// parameters  period (s), dutycycle (0 to 1), enabled, intensity
/// state       LightState; commands: LightCommand, of which `on` and `off` end the blinking
/// edges       a period of 0 shines for ever, as a dutycycle of 1 does; the moment at which the dutycycle
///             ends is dark
engine::DeviceKind blinkenlight_kind();

/// A light that is off until a controller switches it on.
engine::DeviceKind lightindicator_kind();

}  // namespace troupe::models
