#pragma once

#include "render/canvas.hpp"
#include "render/mesh.hpp"
#include "render/theme.hpp"

#include <vector>

namespace troupe::render {

/// A scene and its meshes. A scene has the data to draw that are constant during a run; it must outlive this
/// object. The meshes are computed once and used for all pictures of the scene.
struct SceneMeshes {
  const engine::FrameScene& scene;
  std::vector<Pieces> pieces;  ///< for each type of the scene, the convex pieces of its shapes (pieces_of())
};

/// What a picture shows.
struct Content {
  const SceneMeshes& meshes;     ///< the scene and its meshes
  const engine::Frame& frame;    ///< the data of one time
  std::span<const Rgba> colors;  ///< one per body of Frame::mobile; empty: bodies have their own colours
  const Layers& layers;          ///< the layers that are drawn
  const Theme& theme;

  const engine::FrameScene& scene() const { return meshes.scene; }
  Rgba color_of(std::size_t body) const {  ///< body: index in Frame::mobile
    return colors.empty() ? to_rgba(frame.mobile[body].color) : colors[body];
  }
};

/// Colour of the outline of a stalled robot: one whose last motion was blocked or out of bounds.
inline constexpr Rgba k_stalled_edge = {224, 32, 32, 255};
/// Width of the outline of a stalled robot divided by the width of the outlines of other robots.
inline constexpr float k_stalled_widening = 1.3F;
/// Width of the white line under the outline of a stalled robot divided by the width of this outline. The
/// outline and the white line differ so much that one of them is visible on any background.
inline constexpr float k_stalled_halo = 1.9F;

/// Least width of a robot in the picture, in strokes. Narrower robots are drawn with this width, so that a
/// swarm stays visible in a large world. A stroke is the unit of line widths: 1 pixel in small pictures, more
/// in large ones (Framing::stroke).
inline constexpr double k_smallest_robot = 3.5;
/// On a map (a view from above), robots narrower than this, in strokes (see k_smallest_robot), have no
/// outline, because an outline would hide their colour.
inline constexpr double k_smallest_outlined = 7;
/// On a map (a view from above), robots narrower than this, in strokes (see k_smallest_robot), have no
/// heading mark, because a mark would be too small to see.
inline constexpr double k_smallest_marked = 9;

/// Returns a layer with a single instance of a mesh whose units are pixels right of and above the picture's
/// centre. on_top: whether the layer covers all earlier layers, at any height.
Layer flat(Mesh mesh, bool on_top);

/// Adds the layers of a view from above that show `bodies`, static bodies of the scene such as the floor
/// plan, and their shadows.
void add_flat_fixed(std::vector<AnyLayer>& layers, const Content& content,
                    const std::vector<engine::FrameBody>& bodies, const Framing& framing);
/// Adds the layers of a view from above that show mobile bodies. These layers cover all earlier layers.
void add_flat_mobile(std::vector<AnyLayer>& layers, const Content& content, const Framing& framing);

/// Adds the layers of a view that is not from above, in the order of drawing:
/// - shadows of the bodies
/// - the overlays `on_floor`, which cover the shadows
/// - static bodies
/// - the overlays `in_air`, which nearer static bodies hide
/// - mobile bodies, over `in_air`, because a hundred overlapping range scans would hide the robots
void add_solids(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection,
                std::vector<AnyLayer> on_floor, std::vector<AnyLayer> in_air);

}  // namespace troupe::render
