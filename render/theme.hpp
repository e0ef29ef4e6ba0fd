#pragma once

#include "render/color.hpp"
#include "render/draw.hpp"

namespace troupe::render {

/// The colours of everything except bodies.
struct Theme {
  Rgba ground;  ///< background; opacity 0: transparent
  Rgba shadow;  ///< shadows of bodies
  Rgba grid;    ///< grid lines on the floor
  Rgba ink;     ///< letters, and the lines of legends and scale bar
  Rgba halo;    ///< margin around letters and lines of `ink`
  Rgba line;    ///< bounds of the world, and links between bodies
  Rgba square;  ///< outlines of cells of the spatial index
};

/// Returns the colours that match a background.
const Theme& theme_of(Background background);

}  // namespace troupe::render
