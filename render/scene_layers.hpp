#pragma once

#include "render/canvas.hpp"
#include "render/mesh.hpp"
#include "render/theme.hpp"

#include <vector>

namespace troupe::render {

/// A scene, and what of it is made once for all pictures.
struct SceneMeshes {
  const engine::FrameScene& scene;
  std::vector<Pieces> pieces;  ///< of each type
};

inline constexpr Rgba k_stalled_edge = {224, 32, 32, 255};
/// The outline of a stalled robot is so much wider than one that is not, and lies on a white line so much
/// wider again: one of both is seen on every colour.
inline constexpr float k_stalled_widening = 1.3F;
inline constexpr float k_stalled_halo = 1.9F;

/// A robot is drawn at least this wide, strokes: a swarm stays visible in a large world.
inline constexpr double k_smallest_robot = 3.5;
/// Robots narrower than this, strokes, are plain dots: an outline would hide their colour.
inline constexpr double k_smallest_outlined = 7;
/// Robots narrower than this, strokes, have no heading mark: it would be a speck.
inline constexpr double k_smallest_marked = 9;

/// What lies flat on the picture rather than in the world.
Layer flat(Mesh mesh, bool on_top);

/// From above: the floor plan and whatever else never moves, then what moves. `colors` are the bodies', one
/// each.
void add_flat_fixed(std::vector<AnyLayer>& layers, const SceneMeshes& meshes, const Framing& framing,
                    const Layers& shown, const Theme& theme);
void add_flat_mobile(std::vector<AnyLayer>& layers, const SceneMeshes& meshes, const engine::Frame& frame,
                     std::span<const Rgba> colors, const Framing& framing, const Layers& shown);

/// From elsewhere: both in the order in which they must be drawn, their shadows first. `on_floor` is what
/// lies on the floor, above the shadows and below the bodies. `in_air` is hidden by static bodies and
/// never hides moving ones: a hundred scans one upon another would leave nothing of the robots below.
void add_solids(std::vector<AnyLayer>& layers, const SceneMeshes& meshes, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                const Theme& theme, std::vector<AnyLayer> on_floor, std::vector<AnyLayer> in_air);

}  // namespace troupe::render
