#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

/// The command of an LED: the colour that it shows. It holds until the controller replaces it.
struct LedCommand {
  /// 1: in each tick (time step), the LED takes the colour of this command; 0: it keeps its colour.
  std::uint8_t shows = 0;
  float red = 0;    ///< amount of red, from 0 to 1; other values are clamped, NaN to 0
  float green = 0;  ///< amount of green, from 0 to 1; other values are clamped, NaN to 0
  float blue = 0;   ///< amount of blue, from 0 to 1; other values are clamped, NaN to 0

  static constexpr void describe(engine::Description<LedCommand>& d) {
    d.member<&LedCommand::shows>(
        "shows", "1: the LED takes the colour of this command in each tick; 0: it keeps its colour");
    d.member<&LedCommand::red>("red",
                               "amount of red in the colour to show, from 0 to 1; other values are clamped");
    d.member<&LedCommand::green>(
        "green", "amount of green in the colour to show, from 0 to 1; other values are clamped");
    d.member<&LedCommand::blue>(
        "blue", "amount of blue in the colour to show, from 0 to 1; other values are clamped");
  }

  /// Makes the LED show this colour from the next tick on. r, g, b: red, green and blue, each from 0 to 1.
  void show(float r, float g, float b) { *this = {1, r, g, b}; }
};

/// State of an LED: the present colour of the part of a body that carries the LED. A brush, a device that
/// paints (models/devices/brush.hpp), can also change this colour.
struct LedState {
  std::array<float, 3> shown_color{};  ///< red, green, blue, 0 to 1

  static constexpr void describe(engine::Description<LedState>& d) {
    d.member<&LedState::shown_color>("shown_color", engine::facts::is_appearance,
                                     "colour that the LED shows: red, green, blue, from 0 to 1");
  }
};

/// Returns the definition of the device `led`, which gives a colour to the part of the body that carries the
/// device. It can model an LED or a coat of paint. Blob finders, cameras and ground sensors see this colour,
/// and pictures of the world show it.
///
/// parameters  shows: the colour at the start, white by default
/// when        A commanded colour is visible from the next tick (time step) on.
engine::DeviceKind led_kind();

}  // namespace troupe::models
