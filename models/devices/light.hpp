#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

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

/// What a light shows.
struct LightState {
  std::uint8_t lit = 0;  ///< 1: it shines in this tick
  TROUPE_FIELDS(lit)
};

/// A light that blinks: lit for the first `dutycycle` of each `period`, from tick 0 on.
///
/// parameters  period (s), dutycycle (0 to 1), enabled, intensity
/// state       LightState; commands: LightCommand, of which `on` and `off` end the blinking
/// edges       a period of 0 shines for ever, as a dutycycle of 1 does; the moment at which the dutycycle
///             ends is dark
engine::DeviceKind blinkenlight_kind();

/// Where a light of one of these kinds is, frame of its body or of its joint, and how brightly it shines
/// while it is lit: what a light sensor reads that faces it from 1 m. data: what the kind prepared.
struct LightSource {
  Pose pose_body_light;  ///< its heading means nothing: lights shine all round
  double intensity = 1;  ///< what a sensor that faces it reads at 1 m
};
/// Data: of a kind for which is_light() holds, else std::bad_any_cast is thrown.
const LightSource& light_source(const std::any& data);

/// Whether a device is one of these kinds.
bool is_light(const engine::DeviceKind& kind);

/// A light that is off until a controller switches it on.
engine::DeviceKind lightindicator_kind();

}  // namespace troupe::models
