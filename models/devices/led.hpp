#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

/// The command of an LED: a colour that it takes in each tick if `shows` is 1. It holds until the controller
/// replaces it.
struct LedCommand {
  std::uint8_t shows = 0;  ///< 1: takes the colour; 0: keeps the present one
  float red = 0;           ///< 0 to 1; values outside are clamped
  float green = 0;         ///< as red
  float blue = 0;          ///< as red
  TROUPE_FIELDS(shows, red, green, blue)

  /// Shows this colour from the next tick on. Components from 0 to 1.
  void show(float r, float g, float b) { *this = {1, r, g, b}; }
};

/// State of an LED: the colour of its part. Brushes may change it too (models/devices/brush.hpp).
struct LedState {
  std::array<float, 3> shown_color{};  ///< red, green, blue, 0 to 1

  static constexpr void describe(engine::Description<LedState>& d) {
    d.member<&LedState::shown_color>("shown_color", engine::facts::is_appearance);
  }
};

/// An LED, or paint: it gives the part that carries it a colour, which blob finders, cameras, ground sensors
/// and pictures show.
///
/// parameters  shows: the colour at the start
/// when        a commanded colour is visible from the next tick on
engine::DeviceKind led_kind();

}  // namespace troupe::models
