#pragma once

namespace troupe {

/// Red, green, blue and opacity, each from 0 to 1.
struct Color {
  float r = 1;
  float g = 0;
  float b = 0;
  float a = 1;
  friend bool operator==(const Color&, const Color&) = default;
};

}  // namespace troupe
