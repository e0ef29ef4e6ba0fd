#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// The command of a brush, a device that paints zones (flat coloured bodies on the floor). It holds until the
/// controller replaces it. Without a command, the brush does not paint. A tick is a time step.
struct BrushCommand {
  std::uint8_t paints = 0;  ///< 1: paints the zone below the brush in each tick; 0: does not paint
  float red = 0;            ///< amount of red, from 0 to 1; other values are clamped, NaN to 0
  float green = 0;          ///< amount of green, from 0 to 1; other values are clamped, NaN to 0
  float blue = 0;           ///< amount of blue, from 0 to 1; other values are clamped, NaN to 0

  static constexpr void describe(engine::Description<BrushCommand>& d) {
    d.member<&BrushCommand::paints>("paints", "1: the brush paints the zone below it in each tick");
    d.member<&BrushCommand::red>("red", "amount of red in the paint, from 0 to 1; other values are clamped");
    d.member<&BrushCommand::green>("green",
                                   "amount of green in the paint, from 0 to 1; other values are clamped");
    d.member<&BrushCommand::blue>("blue",
                                  "amount of blue in the paint, from 0 to 1; other values are clamped");
  }

  /// Makes the brush paint with this colour from the next tick on. r, g, b: red, green and blue, each from 0
  /// to 1.
  void paint(float r, float g, float b) { *this = {1, r, g, b}; }
};

/// State of a brush.
struct BrushState {
  std::uint64_t painted = 0;  ///< number of ticks in which the brush changed the colour of a zone

  static constexpr void describe(engine::Description<BrushState>& d) {
    d.member<&BrushState::painted>("painted",
                                   "number of ticks in which the brush changed the colour of a zone");
  }
};

/// Returns the definition of the device `brush`: it gives the zone (a flat coloured body on the floor) below
/// it the commanded colour. Only zones that carry a device of the kind `led`, which stores the colour, can be
/// painted; over other zones, and where there is no zone, the brush has no effect. If several brushes paint a
/// zone in the same tick, the zone gets the colour of the brush whose body has the highest id.
engine::DeviceKind brush_kind();

}  // namespace troupe::models
