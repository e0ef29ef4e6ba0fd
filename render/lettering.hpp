#pragma once

#include "base/pose.hpp"
#include "render/mesh.hpp"

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

/// The lines with a halo of the paper's colour.
void add_written(Mesh& mesh, const Lines& lines, double stroke);

}  // namespace troupe::render
