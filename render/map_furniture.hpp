#pragma once

#include "render/framing.hpp"
#include "render/mesh.hpp"

#include <string>

namespace troupe::render {

/// 1, 2 or 5 times a power of ten: the largest such length, m, that is at most `metres`.
struct RoundLength {
  double metres = 1;
  int exponent = 0;  ///< of ten

  static RoundLength at_most(double metres);
  /// "50 m", "0.2 m", "2 km", "5 mm".
  std::string text() const;
};

/// The lines of a floor grid, one pixel wide where strokes are, in pixels about the picture's middle.
Mesh floor_grid(const Framing& framing);
/// The scale bar with its length on the left, the simulated time on the right, in the picture's lower
/// corners.
Mesh scale_and_time(const Framing& framing, double time_s);

}  // namespace troupe::render
