#pragma once

#include "base/pose.hpp"
#include "render/mesh.hpp"
#include "render/theme.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::render {

/// Line segments. Their ends are in pixels right of and above the picture's centre. mesh_of() draws each
/// segment twice: first wide in the colour Theme::halo, then narrow in the colour Theme::ink. So the segment
/// is readable on any background.
using Lines = std::vector<std::pair<Vec2, Vec2>>;

/// Usual height of capitals and digits, in strokes. A stroke is the unit of line widths: 1 pixel in small
/// pictures, more in large ones (Framing::stroke).
inline constexpr double k_cap_height = 11;

/// Adds the letters of `text` to `lines`. pen: start of the baseline, pixels right of and above the picture's
/// centre. unit: a sixth of the height of capitals, pixels; letters such as g reach 2 units below the
/// baseline. Each character outside printable ASCII is drawn as an empty box.
void add_text(Lines& lines, std::string_view text, const Vec2& pen, double unit);
/// Returns the width of a text from the pen to the right end of the last letter, pixels. `unit` is that of
/// add_text(). The text must not be empty, because the result would be negative.
double text_width(std::string_view text, double unit);

/// One line of text. Positions are in pixels right of and above the picture's centre.
struct Text {
  std::string text;
  Vec2 pen = Vec2::Zero();   ///< start of its baseline, or the end if `ends_at_pen`
  double unit = 1;           ///< a sixth of the height of a capital letter, pixels
  bool ends_at_pen = false;  ///< true: the text ends at the pen; false: it starts there
};

/// The lettering of a picture: texts, and the lines and bars that belong to them.
struct Writing {
  /// Bars and coloured squares over which the lines and texts are drawn, pixels right of and above the
  /// picture's centre.
  Mesh under;
  Lines lines;              ///< lines, such as those of the scale bar
  std::vector<Text> texts;  ///< the texts; vector formats store them as text, not as lines
};

// Widths of the halo (the margin around lines and letters) and of the lines and letters themselves, in
// strokes (Framing::stroke).
inline constexpr double k_halo_strokes = 5;
inline constexpr double k_ink_strokes = 1.4;

/// Returns the lettering as triangles, each line and letter with a margin in the colour Theme::halo.
/// Positions are in pixels right of and above the picture's centre. stroke: pixels per stroke
/// (Framing::stroke).
Mesh mesh_of(const Writing& writing, double stroke, const Theme& theme);

}  // namespace troupe::render
