#pragma once

#include "render/color.hpp"
#include "render/draw.hpp"

namespace troupe::render {

/// The colours of everything except bodies.
struct Theme {
  Rgba ground;  ///< opacity 0: none
  Rgba shadow;
  Rgba grid;
  Rgba ink;     ///< letters and lines
  Rgba halo;    ///< around letters and lines
  Rgba line;    ///< bounds and links
  Rgba square;  ///< outlines of cells
};

const Theme& theme_of(Background background);

}  // namespace troupe::render
