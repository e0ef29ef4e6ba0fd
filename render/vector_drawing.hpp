#pragma once

#include "base/geometry.hpp"
#include "render/canvas.hpp"
#include "render/lettering.hpp"
#include "render/theme.hpp"

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::render {

/// A path of filled outlines or of lines, in pixels from the upper left corner, y down.
struct VectorPath {
  std::vector<Ring> rings;
  Rgba color{};
  double width = 0;        ///< width of lines, pixels; 0: the rings are filled, overlaps included
  bool is_closed = false;  ///< for lines: the last point of each is joined to its first
};

/// One line of text.
struct VectorText {
  std::string text;         ///< UTF-8
  Vec2 pen = Vec2::Zero();  ///< start of its baseline; its end if `ends_at_pen`
  bool ends_at_pen = false;
  double cap_height = 11;  ///< pixels
  Rgba color{};
  Rgba halo{};
  double halo_width = 0;  ///< pixels beyond the letters
};

/// A picture as paths and texts, in the order of drawing.
struct VectorDrawing {
  int width = 0;  ///< pixels of 1/96 inch
  int height = 0;
  Rgba ground{};  ///< opacity 0: none
  std::vector<std::variant<VectorPath, VectorText>> items;
};

/// The layers and the lettering of a map as a drawing. Joins triangles to the polygons they were made of, and
/// strokes to lines. Sorts flat layers by height, as the depth buffer does for pixels.
VectorDrawing vector_drawing(const Projection& projection, std::span<const AnyLayer> layers,
                             const Writing& writing, const Theme& theme);

/// The drawing as SVG 1.1, with texts as text.
std::string svg_text(const VectorDrawing& drawing, const FileTexts& texts);
/// The drawing as PDF 1.5 with embedded fonts. Throws std::runtime_error, with the package to install, if
/// cairo is missing.
std::string pdf_text(const VectorDrawing& drawing, const FileTexts& texts);

}  // namespace troupe::render
