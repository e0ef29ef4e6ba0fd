#pragma once

#include "render/framing.hpp"
#include "render/lettering.hpp"
#include "render/mesh.hpp"

#include <string>

namespace troupe::render {

/// Distance of the scale bar, the texts and the legends from the edges of the picture, in strokes. A stroke
/// is the unit of line widths: 1 pixel in small pictures, more in large ones (Framing::stroke).
inline constexpr double k_furniture_margin = 14;

/// A length of 1, 2 or 5 times a power of ten, m.
struct RoundLength {
  double metres = 1;
  int exponent = 0;  ///< exponent of the power of ten

  /// Returns the largest round length that is at most `metres`, which must be positive and finite. Rounding
  /// errors have two effects: if `metres` is a power of ten, the result can be half of it; and the result can
  /// be a power of ten that exceeds `metres` by a rounding error.
  static RoundLength at_most(double metres);
  /// Returns the length as text, such as "50 m", "0.2 m", "2 km" or "5 mm".
  std::string text() const;
};

/// Returns the lines of the floor grid of a map (a view from above) as rectangles. Positions are in pixels
/// right of and above the picture's centre. The width of the lines is one stroke, rounded to whole pixels.
/// The distance between neighbouring lines is a RoundLength, and at least 48 strokes in the picture.
Mesh floor_grid(const Framing& framing, Rgba color);
/// Selects the scale bar and the texts along the picture's lower edge.
struct Furniture {
  bool scale = true;  ///< a scale bar with its length, in the left corner
  std::string left;   ///< text right of the scale bar, or in the left corner if there is no scale bar
  std::string right;  ///< text in the right corner: the time
};
/// Returns the text of the clock: "12.5 s", or "12.5 s  40 x real time" if `times_real_time` is above 0.
std::string clock_text(double time_s, double times_real_time = 0);
/// Adds the scale bar and the texts of `shown` to `writing`. Adds nothing if the picture is too small
/// (Framing::has_furniture()). Empty texts are omitted.
void add_furniture(Writing& writing, const Framing& framing, const Furniture& shown);

}  // namespace troupe::render
