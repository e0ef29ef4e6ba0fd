#pragma once

#include "base/geometry.hpp"

namespace troupe::render {

/// Size and scale of a view from above, and the part of the world that it shows.
struct Framing {
  int width = 0;   ///< width of the picture, pixels
  int height = 0;  ///< height of the picture, pixels
  double pixels_per_metre = 1;
  Vec2 center = Vec2::Zero();  ///< world point in the centre of the picture, m
  /// Pixels per stroke. Widths of lines and letters are given in strokes. A stroke is 1 pixel in pictures
  /// whose smaller side has up to 900 pixels, and grows in proportion above, so that large pictures look like
  /// small ones.
  double stroke = 1;

  /// Position of a world point: pixels right of and above the picture's centre.
  Vec2 to_pixels(const Vec2& world) const { return pixels_per_metre * (world - center); }
  /// The region of the world that the picture shows, m.
  Box world() const {
    const Vec2 half = Vec2(width, height) / (2 * pixels_per_metre);
    return {center - half, center + half};
  }
  /// Whether the picture is large enough for the scale bar, the simulated time and the legends.
  bool has_furniture() const { return width >= 240 && height >= 160; }
};

}  // namespace troupe::render
