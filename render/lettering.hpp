#pragma once

#include "base/pose.hpp"
#include "render/mesh.hpp"
#include "render/theme.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::render {

/// Line segments in pixels from the picture's centre. Each is drawn twice, as a halo and in ink, so that it
/// is readable on any background.
using Lines = std::vector<std::pair<Vec2, Vec2>>;

/// Height of capitals and digits, strokes.
inline constexpr double k_cap_height = 11;

/// Adds letters as line segments. Capitals are 6 units high, descenders reach 2 units below the baseline.
/// Characters outside printable ASCII are drawn as empty boxes.
void add_text(Lines& lines, std::string_view text, const Vec2& pen, double unit);
/// Width from the pen to the right end of the last letter, pixels.
double text_width(std::string_view text, double unit);

/// One line of text, in pixels from the picture's centre.
struct Text {
  std::string text;
  Vec2 pen = Vec2::Zero();  ///< start of its baseline; its end if `ends_at_pen`
  double unit = 1;          ///< a sixth of the height of its capitals, pixels
  bool ends_at_pen = false;
};

/// The lettering of a picture. Vector formats keep `texts` as text.
struct Writing {
  Mesh under;  ///< bars and swatches of legends, in the same coordinates
  Lines lines;
  std::vector<Text> texts;
};

// Widths of lines and letters, strokes.
inline constexpr double k_halo_strokes = 5;
inline constexpr double k_ink_strokes = 1.4;

/// The lettering as triangles; lines and letters have a halo.
Mesh mesh_of(const Writing& writing, double stroke, const Theme& theme);

}  // namespace troupe::render
