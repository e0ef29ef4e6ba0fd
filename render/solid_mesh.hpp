#pragma once

#include "render/mesh.hpp"

#include <Eigen/Core>

namespace troupe::render {

/// What prism_mesh() draws in addition to the faces. A type (engine::FrameType) is a list of solid shapes;
/// bodies that look alike have the same type.
struct SolidStyle {
  float edge = 0;          ///< width of the lines along edges, pixels; 0: no lines
  float halo = 0;          ///< width of a white line under each line of width `edge`, as MeshStyle::halo
  bool mark = false;       ///< whether there is a triangle at the front that points forward
  double least_side = 0;   ///< vertical edges next to a side shorter than this, m, have no line
  double least_edged = 0;  ///< shapes shorter than this along both x and y, m, have no lines
};

/// Returns the shapes of a type as prisms without undersides, in its body frame, m. `pieces` must be
/// pieces_of(type), the convex pieces of the shapes.
SolidMesh prism_mesh(const engine::FrameType& type, const Pieces& pieces, const SolidStyle& style);
/// Returns a box around all shapes of a type, without underside, in its body frame, m. Its colour is
/// Paint::body (the colour of the body that is drawn). Bodies that are only a few pixels wide are drawn as
/// this box. Empty if the type has no shapes.
SolidMesh box_mesh(const engine::FrameType& type);
/// Returns the faces of a mesh, without its lines and marks, for a layer with SolidLayer::shadow.
SolidMesh shadow_mesh(const SolidMesh& mesh);

/// Returns the interval of heights of the shapes of a type, body frame, m; [0, 0] without shapes.
ZInterval heights_of(const engine::FrameType& type);

/// Adds a line from a to b, which are in mesh units of SolidInstance::scale metres. width: pixels. paint:
/// selects the colour; own: the colour if `paint` is Paint::own. corner: Corner::stroke for a normal line, or
/// Corner::rim for a line that normal lines cover.
void add_stroke(SolidMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double width,
                Paint paint, Rgba own = {}, Corner corner = Corner::stroke);
/// Adds an unlit triangle (Corner::plain) of the colour `own`.
void add_plain(SolidMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
               Rgba own);

}  // namespace troupe::render
