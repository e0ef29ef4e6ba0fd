#pragma once

#include "base/geometry.hpp"

namespace troupe::render {

/// Size and scale of a view from above, and the part of the world that it shows.
struct Framing {
  int width = 0;   ///< width of the picture, pixels
  int height = 0;  ///< height of the picture, pixels
  double pixels_per_metre = 1;
  Vec2 center = Vec2::Zero();  ///< world point in the centre of the picture, m
  /// Unit of the widths of lines and the sizes of letters, pixels. A stroke is 1 pixel if the smaller side of
  /// the picture has at most 900 pixels. Otherwise it is 1/900 of this side, so that large pictures look like
  /// small ones.
  double stroke = 1;

  /// Returns the position of a world point (m) in the picture: pixels right of and above the picture's
  /// centre.
  Vec2 to_pixels(const Vec2& world) const { return pixels_per_metre * (world - center); }
  /// Returns the region of the world that the picture shows, m.
  Box world() const {
    const Vec2 half = Vec2(width, height) / (2 * pixels_per_metre);
    return {center - half, center + half};
  }
  /// Returns whether the picture is large enough for the scale bar, the simulated time and the legends.
  bool has_furniture() const { return width >= 240 && height >= 160; }
};

}  // namespace troupe::render
