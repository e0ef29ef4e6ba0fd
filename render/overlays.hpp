#pragma once

#include "render/lettering.hpp"
#include "render/scene_layers.hpp"

#include <vector>

namespace troupe::render {

/// The floor grid of a view that is not from above: lines on the floor around the scene, `pitch` metres
/// apart.
SolidLayer solid_grid(const engine::FrameScene& scene, const Projection& projection, double pitch,
                      Rgba color);
/// The distance between grid lines for this view, m.
double grid_pitch(const Projection& projection);

/// Adds those overlays on the floor, below the bodies, that `shown` selects: coverage, density, tiles, cells,
/// bounds, footprints, trails. colors: colours of the bodies in this frame, or empty if bodies have their own
/// colours.
void add_on_floor(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                  std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                  const Theme& theme);

/// Adds those overlays above the floor that `shown` selects: scans, beams, sights, blobs. colors: as for
/// add_on_floor(). depth: `floor` in a view from above, `air` in other views.
void add_in_air(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                SolidLayer::Depth depth);

/// Adds those overlays that connect bodies and that `shown` selects: links, grips. No body hides them.
void add_ties(std::vector<AnyLayer>& layers, const engine::Frame& frame, const Projection& projection,
              const Layers& shown, const Theme& theme);

/// The lettering of the picture that `view.layers` selects: names, energy bars, legends, clock, and the scale
/// bar or, in a view that is not from above, the distance between grid lines.
Writing written(const engine::FrameScene& scene, const engine::Frame& frame, const Projection& projection,
                const Framing& framing, const View& view);

}  // namespace troupe::render
