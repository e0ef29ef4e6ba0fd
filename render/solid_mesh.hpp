#pragma once

#include "render/mesh.hpp"

#include <Eigen/Core>

namespace troupe::render {

struct SolidStyle {
  float edge = 0;          ///< width of the lines along edges, pixels; 0: none
  float halo = 0;          ///< width of a white line below each of them, pixels; 0: none
  bool mark = false;       ///< a triangle that points forward, at the front
  double least_side = 0;   ///< m: corners between shorter sides, such as the steps of a bitmap, have no line
  double least_edged = 0;  ///< m: narrower shapes have no lines
};

/// The shapes of a type as prisms without undersides, in its body frame, m.
SolidMesh prism_mesh(const engine::FrameType& type, const Pieces& pieces, const SolidStyle& style);
/// A box around all shapes of a type, in the body's colour, for bodies of a few pixels.
SolidMesh box_mesh(const engine::FrameType& type);
/// Only the faces, all in the colour of edges, for shadows.
SolidMesh shadow_mesh(const SolidMesh& mesh);

/// The interval of heights of the shapes of a type, body frame, m.
ZInterval heights_of(const engine::FrameType& type);

/// Adds a line; `width` is in pixels.
void add_stroke(SolidMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double width,
                Paint paint, Rgba own = {}, Corner corner = Corner::stroke);
/// Adds an unlit triangle.
void add_plain(SolidMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
               Rgba own);

}  // namespace troupe::render
