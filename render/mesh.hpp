#pragma once

#include "render/canvas.hpp"

namespace troupe::render {

/// What body_mesh() draws in addition to the faces. A type (engine::FrameType) is a list of solid shapes;
/// bodies that look alike have the same type.
struct MeshStyle {
  float edge = 0;  ///< width of the outline of each contour, pixels; 0: no outline
  /// Width of a white line drawn under the outline, pixels; 0: no line. With this line, the outlines of all
  /// shapes have the colour Paint::edge. Without it, those of shapes with a colour of their own are a darker
  /// shade of it.
  float halo = 0;
  /// Shapes shorter than this along both x and y, m, have no outline, because an outline would hide their
  /// colour (for example that of an LED). The widest shape of a type keeps its outline, whatever its size.
  double least_edged = 0;
  bool mark = false;  ///< whether there is a heading mark: a triangle at the front that points forward
};

/// Converts a colour with components from 0 to 1 to bytes, each component by to_byte() (base/color.hpp).
Rgba to_rgba(const Color& color);
/// Returns the colour for the outline of a shape of the colour `fill`: red, green and blue are 65 % of those
/// of `fill`, and the opacity is the same.
Rgba darker(Rgba fill);
/// Returns a colour that is readable on `fill`: white if `fill` is dark, near black if it is light.
Rgba contrasting(Rgba fill);

/// Returns the longer side of the axis-aligned rectangle around a solid, m; 0 if the solid is empty.
double width_of(const Solid& solid);

/// The convex pieces of each shape of a type (engine::FrameType), in the order of the shapes. Callers compute
/// the pieces once per type and keep them, because the computation takes long for large floor plans.
using Pieces = std::vector<std::vector<ConvexPrism>>;
Pieces pieces_of(const engine::FrameType& type);

/// Returns the top faces of the shapes of a type in its body frame, m, with the outlines and the heading mark
/// that `style` selects. Shapes with lower tops come first, the heading mark last. Shapes without a colour of
/// their own have the colours of the drawn body (Paint::body, Paint::edge and Paint::mark). `pieces` must be
/// pieces_of(type).
Mesh body_mesh(const engine::FrameType& type, const Pieces& pieces, const MeshStyle& style);
/// Returns the surfaces of a mesh, without its lines, all in the colour Paint::body (the colour of the body
/// that is drawn). Views from above draw this mesh as the shadow of a body.
Mesh silhouette(Mesh mesh);

/// Adds a line from a to b. a and b are in mesh units of Instance::size pixels. z: height of the line, m.
/// width: pixels. The ends of the line are square and extend beyond a and b by half the width, so that the
/// lines of an outline have no gaps at its corners. paint: selects the colour; own: the colour if `paint` is
/// Paint::own.
void add_stroke(Mesh& mesh, const Vec2& a, const Vec2& b, double z, double width, Paint paint, Rgba own = {});
/// Adds a filled rectangle of the colour `own` at the height 0. min: its lower left corner; max: its upper
/// right corner; both in mesh units of Instance::size pixels.
void add_rectangle(Mesh& mesh, const Vec2& min, const Vec2& max, Rgba own);

}  // namespace troupe::render
