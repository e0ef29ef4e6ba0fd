#pragma once

#include "base/geometry.hpp"

namespace troupe::render {

/// Which part of the world a picture shows.
struct Framing {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  double pixels_per_metre = 1;
  Vec2 center = Vec2::Zero();  ///< world point in the middle of the picture
  /// Pixels a stroke unit: 1 up to about 900 rows, then growing, so that a poster looks like a small picture.
  double stroke = 1;

  /// Pixels right of and above the picture's middle.
  Vec2 to_pixels(const Vec2& world) const { return pixels_per_metre * (world - center); }
  Box world() const {
    const Vec2 half = Vec2(width, height) / (2 * pixels_per_metre);
    return {center - half, center + half};
  }
  /// The scale bar and the time need room.
  bool has_furniture() const { return width >= 240 && height >= 160; }
};

}  // namespace troupe::render
