#pragma once

#include "render/canvas.hpp"
#include "render/mesh.hpp"
#include "render/theme.hpp"

#include <vector>

namespace troupe::render {

/// A scene, with data that are computed once for all pictures.
struct SceneMeshes {
  const engine::FrameScene& scene;
  std::vector<Pieces> pieces;  ///< by type
};

inline constexpr Rgba k_stalled_edge = {224, 32, 32, 255};
/// Factors by which the outline of a stalled robot is wider than that of other robots, and the white line
/// below it wider than the outline. One of the two contrasts with any colour.
inline constexpr float k_stalled_widening = 1.3F;
inline constexpr float k_stalled_halo = 1.9F;

/// Least width of a robot, strokes, so that a swarm stays visible in a large world.
inline constexpr double k_smallest_robot = 3.5;
/// Robots narrower than this, strokes, have no outline, which would hide their colour.
inline constexpr double k_smallest_outlined = 7;
/// Robots narrower than this, strokes, have no heading mark, which would be too small to see.
inline constexpr double k_smallest_marked = 9;

/// A layer with one instance of a mesh that is already in pixels of the picture.
Layer flat(Mesh mesh, bool on_top);

/// Add the layers of a view from above: static bodies such as the floor plan, and mobile bodies. `colors` has
/// one colour per body.
void add_flat_fixed(std::vector<AnyLayer>& layers, const SceneMeshes& meshes, const Framing& framing,
                    const Layers& shown, const Theme& theme);
void add_flat_mobile(std::vector<AnyLayer>& layers, const SceneMeshes& meshes, const engine::Frame& frame,
                     std::span<const Rgba> colors, const Framing& framing, const Layers& shown);

/// Adds the layers of other views: static and mobile bodies in the order in which they must be drawn, shadows
/// first. `on_floor` is drawn above the shadows and below the bodies. `in_air` is hidden by static bodies and
/// never hides mobile bodies: a hundred overlapping scans would cover the robots below.
void add_solids(std::vector<AnyLayer>& layers, const SceneMeshes& meshes, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                const Theme& theme, std::vector<AnyLayer> on_floor, std::vector<AnyLayer> in_air);

}  // namespace troupe::render
