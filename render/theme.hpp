#pragma once

#include "render/color.hpp"
#include "render/draw.hpp"

namespace troupe::render {

/// The colours of what is no body.
struct Theme {
  Rgba ground;  ///< opacity 0: none
  Rgba shadow;
  Rgba grid;
  Rgba ink;     ///< of what is written
  Rgba halo;    ///< around it
  Rgba line;    ///< of bounds and links
  Rgba square;  ///< of the outlines of cells
};

const Theme& theme_of(Background background);

}  // namespace troupe::render
