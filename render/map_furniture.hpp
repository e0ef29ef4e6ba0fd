#pragma once

#include "render/framing.hpp"
#include "render/lettering.hpp"
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
Mesh floor_grid(const Framing& framing, Rgba color);
/// What is written along the picture's lower edge.
struct Furniture {
  bool scale = true;  ///< a bar with its length, in the left corner
  std::string left;   ///< behind it
  std::string right;  ///< in the right corner: the time
};
/// "12.5 s", "12.5 s  40 x real time"; 0 times real time is not told.
std::string clock_text(double time_s, double times_real_time = 0);
/// All of it, in pixels about the picture's middle; nothing where the picture is too small.
void add_furniture(Writing& writing, const Framing& framing, const Furniture& shown);

}  // namespace troupe::render
