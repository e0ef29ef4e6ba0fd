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

/// Outlines that are filled together, or lines that are drawn together; pixels from the upper left corner, y
/// down.
struct VectorPath {
  std::vector<Ring> rings;
  Rgba color{};
  double width = 0;        ///< of lines, pixels; 0: the rings are filled, where they overlap too
  bool is_closed = false;  ///< of lines: the last point of each is joined to its first
};

/// One line of text.
struct VectorText {
  std::string text;         ///< UTF-8
  Vec2 pen = Vec2::Zero();  ///< where its baseline begins, or ends
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

/// The layers of a map, and what is written on it. Triangles are joined to the polygons that they were made
/// of, strokes to lines; layers that lie flat are sorted by height, as the depth buffer does it for pixels.
VectorDrawing vector_drawing(const Projection& projection, std::span<const AnyLayer> layers,
                             const Writing& writing, const Theme& theme);

/// The drawing as SVG 1.1: paths, and texts that stay texts.
std::string svg_text(const VectorDrawing& drawing, const FileTexts& texts);
/// The drawing as PDF 1.5, its letters embedded. Throws std::runtime_error where cairo is missing, with the
/// package to install.
std::string pdf_text(const VectorDrawing& drawing, const FileTexts& texts);

}  // namespace troupe::render
