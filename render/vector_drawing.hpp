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

/// A path of filled outlines, or of lines.
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

/// Converts the layers and the lettering of a map, which is a view from above, to a drawing. The projection
/// must be one from above (Projection::from_above()). Consecutive triangles of a triangle fan are joined to a
/// polygon, and consecutive line segments to a polyline, if they have the same colour, line width and height.
/// A drawing has no depth buffer: the paths of consecutive layers are sorted by height and drawn in that
/// order. A layer with `on_top` begins a new group of paths, which is sorted separately and drawn after all
/// earlier paths. The paths of a SolidLayer form a group that is not sorted. In texts, printable_utf8()
/// replaces characters that SVG or PDF does not allow.
VectorDrawing vector_drawing(const Projection& projection, std::span<const AnyLayer> layers,
                             const Writing& writing, const Theme& theme);

/// Replaces characters that SVG or PDF does not allow by question marks, one per byte: bytes that are not
/// valid UTF-8, control characters of ASCII (U+0000 to U+001F, U+007F) and Unicode noncharacters.
std::string printable_utf8(std::string_view text);

/// The drawing as the content of an SVG 1.1 file with the metadata `texts`. The metadata and the texts of the
/// drawing must be valid UTF-8. The texts of the drawing are stored as text, not as paths.
std::string svg_text(const VectorDrawing& drawing, const FileTexts& texts);
/// The drawing as the content of a PDF file with embedded fonts and the metadata `texts`. The metadata and
/// the texts of the drawing must be valid UTF-8. Throws std::runtime_error if cairo is missing or too old
/// (the message names the package to install), or if cairo fails.
std::string pdf_text(const VectorDrawing& drawing, const FileTexts& texts);

}  // namespace troupe::render
