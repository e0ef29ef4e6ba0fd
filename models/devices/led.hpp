#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

/// What controllers ask of an LED: nothing, as long as they do not say `shows`; then this colour in each
/// tick.
struct LedCommand {
  std::uint8_t shows = 0;  ///< 1: the colour that follows
  float red = 0;           ///< each from 0 to 1; what lies beyond is the nearest of these
  float green = 0;         ///< likewise
  float blue = 0;          ///< likewise
  TROUPE_FIELDS(shows, red, green, blue)

  /// This colour from the next tick on, each part 0 to 1.
  void show(float r, float g, float b) { *this = {1, r, g, b}; }
};

/// The colour of the part that carries it. Others may change it, as brushes do (models/devices/brush.hpp).
struct LedState {
  std::array<float, 3> shown_color{};  ///< red, green, blue

  static constexpr void describe(engine::Description<LedState>& d) {
    d.member<&LedState::shown_color>("shown_color", engine::facts::is_look);
  }
};

/// An LED, or paint: the part that carries it has the colour that it was given last, to blob finders and
/// cameras, to what looks at the ground, and in pictures.
///
/// parameters  color: with which it begins
/// when        a colour that a controller asks for is there from the next tick on
engine::DeviceKind led_kind();

}  // namespace troupe::models
