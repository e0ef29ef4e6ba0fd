#pragma once

#include "render/canvas.hpp"

namespace troupe::render {

struct MeshStyle {
  float edge = 0;     ///< width of the outline of each contour, pixels; 0: none
  float halo = 0;     ///< width of a white line below the outline, pixels; 0: none
  bool mark = false;  ///< a triangle that points forward, at the front
};

Rgba to_rgba(const Color& color);
/// The colour of an outline around `fill`.
Rgba darker(Rgba fill);
/// White on dark colours, near black on light ones.
Rgba contrasting(Rgba fill);

/// Convex pieces of each shape of a type, in the order of shapes. Computed once, because large floor plans
/// take long.
using Pieces = std::vector<std::vector<ConvexPrism>>;
Pieces pieces_of(const engine::FrameType& type);

/// The top faces of a type in its body frame, m; lower shapes first, the mark last.
Mesh body_mesh(const engine::FrameType& type, const Pieces& pieces, const MeshStyle& style);
/// The mesh without strokes, all in the body's colour.
Mesh silhouette(Mesh mesh);

/// Adds a line from a to b whose square ends extend half its width beyond them, so that corners close. The
/// ends are in mesh units, the width in pixels.
void add_stroke(Mesh& mesh, const Vec2& a, const Vec2& b, double z, double width, Paint paint, Rgba own = {});
void add_rectangle(Mesh& mesh, const Vec2& min, const Vec2& max, Rgba own);

}  // namespace troupe::render
