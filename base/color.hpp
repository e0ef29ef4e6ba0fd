#pragma once

#include <algorithm>
#include <cstdint>

namespace troupe {

/// Red, green, blue and opacity, each from 0 to 1. The default is opaque red.
struct Color {
  float r = 1;  ///< red, 0 to 1
  float g = 0;  ///< green, 0 to 1
  float b = 0;  ///< blue, 0 to 1
  float a = 1;  ///< opacity: 0 is transparent, 1 opaque
  friend bool operator==(const Color&, const Color&) = default;
};

/// Converts a colour component to 8 bits: clamps `part` to [0, 1], multiplies it by 255 and rounds to the
/// nearest integer, halves upwards. `part` must not be NaN.
inline std::uint8_t to_byte(float part) {
  return static_cast<std::uint8_t>((static_cast<int>(std::clamp(part, 0.0f, 1.0f) * 510) + 1) / 2);
}

}  // namespace troupe
