#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The command of a brush, which paints the zone (a flat coloured body on the floor) below it in each tick
/// (simulation step). The command holds until the controller replaces it. Without a command, the brush does
/// not paint.
struct BrushCommand {
  std::uint8_t paints = 0;  ///< 1: paints the zone below the brush in each tick
  float red = 0;            ///< amount of red, from 0 to 1; other values are clamped, NaN to 0
  float green = 0;          ///< amount of green, from 0 to 1; other values are clamped, NaN to 0
  float blue = 0;           ///< amount of blue, from 0 to 1; other values are clamped, NaN to 0

  static constexpr void describe(engine::Description<BrushCommand>& d) {
    d.member<&BrushCommand::paints>("paints", "1: the brush paints the zone below it in each tick");
    d.member<&BrushCommand::red>("red", "amount of red in the paint, from 0 to 1");
    d.member<&BrushCommand::green>("green", "amount of green in the paint, from 0 to 1");
    d.member<&BrushCommand::blue>("blue", "amount of blue in the paint, from 0 to 1");
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

/// Returns the definition of the device `brush`: it gives the zone (a flat coloured body) below it the
/// commanded colour, if the zone carries a device of the kind `led`, which holds the colour. Without such a
/// zone, painting has no effect. If several brushes paint a zone in the same tick, the brush of the body with
/// the highest id determines the colour of the zone.
engine::DeviceKind brush_kind();

}  // namespace troupe::models
