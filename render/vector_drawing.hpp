#pragma once

#include "base/geometry.hpp"
#include "render/canvas.hpp"
#include "render/lettering.hpp"
#include "render/theme.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::render {

/// A path: filled polygons if `width` is 0, otherwise lines.
struct VectorPath {
  std::vector<Ring> rings;  ///< points in pixels from the picture's upper left corner, y down
  Rgba color{};
  double width = 0;        ///< width of lines, pixels; 0: rings are filled, by the nonzero winding rule
  bool is_closed = false;  ///< for lines: whether the last point of each ring is joined to its first
};

/// One line of text.
struct VectorText {
  std::string text;  ///< the text, UTF-8
  /// Start of its baseline, or the end if `ends_at_pen`; pixels from the picture's upper left corner, y down.
  Vec2 pen = Vec2::Zero();
  bool ends_at_pen = false;  ///< true: the text ends at the pen; false: it starts there
  double cap_height = 11;    ///< height of capitals, pixels
  Rgba color{};
  Rgba halo{};            ///< colour of a margin around the letters
  double halo_width = 0;  ///< width of this margin, pixels
};

/// A picture as paths and texts, in the order of drawing.
struct VectorDrawing {
  int width = 0;   ///< width, pixels of 1/96 inch
  int height = 0;  ///< height, pixels of 1/96 inch
  Rgba ground{};   ///< background; opacity 0: no background
  std::vector<std::variant<VectorPath, VectorText>> items;
};

/// Converts the layers and the lettering of a map to a drawing. A map is a view from above, so `projection`
/// must come from Projection::from_above().
///
/// A drawing has no depth buffer: later paths cover earlier ones. Therefore consecutive layers form groups,
/// and the paths of each group are sorted by height. A layer with `on_top` begins a new group. A SolidLayer
/// is a group of its own, whose paths are not sorted.
///
/// Consecutive triangles of a triangle fan become one polygon, and consecutive line segments one line, if
/// they have the same colour, line width and height. In texts, printable_utf8() replaces characters that SVG
/// or PDF does not allow.
VectorDrawing vector_drawing(const Projection& projection, std::span<const AnyLayer> layers,
                             const Writing& writing, const Theme& theme);

/// Returns `text` with question marks instead of the characters that SVG or PDF does not allow: control
/// characters of ASCII (U+0000 to U+001F, U+007F), Unicode noncharacters, and bytes that are not valid UTF-8.
/// Each byte of such a character becomes one question mark.
std::string printable_utf8(std::string_view text);

/// Returns the drawing as the content of an SVG 1.1 file with the metadata `texts`. The metadata and the
/// texts of the drawing must be valid UTF-8. The texts of the drawing are stored as text, not as paths.
std::string svg_text(const VectorDrawing& drawing, const FileTexts& texts);
/// Returns the drawing as the content of a PDF file with embedded fonts and the metadata `texts`. The
/// metadata and the texts of the drawing must be valid UTF-8. Throws std::runtime_error if cairo is missing
/// or too old (the message names the package to install), or if cairo fails.
std::string pdf_text(const VectorDrawing& drawing, const FileTexts& texts);

}  // namespace troupe::render
