#pragma once

#include "base/pose.hpp"
#include "render/mesh.hpp"
#include "render/theme.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::render {

/// Lines in pixels about the picture's middle: what is written on a picture is drawn twice, as its own halo
/// and in ink, so that it can be read on anything.
using Lines = std::vector<std::pair<Vec2, Vec2>>;

/// Height of capitals and figures, strokes.
inline constexpr double k_cap_height = 11;

/// Letters drawn as lines: capitals are 6 units high, what hangs below the line reaches 2 units down.
/// Printable ASCII; every other character is an empty box.
void add_text(Lines& lines, std::string_view text, const Vec2& pen, double unit);
/// From the pen to the right end of the last letter.
double text_width(std::string_view text, double unit);

/// One line of letters, in pixels about the picture's middle.
struct Text {
  std::string text;
  Vec2 pen = Vec2::Zero();  ///< where its baseline begins, or ends
  double unit = 1;          ///< a sixth of the height of its capitals, pixels
  bool ends_at_pen = false;
};

/// What is written on a picture: letters stay letters where a file can hold them.
struct Writing {
  Mesh under;  ///< bars and swatches of legends, in the same coordinates
  Lines lines;
  std::vector<Text> texts;
};

// Widths of what is written, strokes.
inline constexpr double k_halo_strokes = 5;
inline constexpr double k_ink_strokes = 1.4;

/// All of it as triangles: lines and letters have a halo.
Mesh mesh_of(const Writing& writing, double stroke, const Theme& theme);

}  // namespace troupe::render
