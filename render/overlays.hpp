#pragma once

#include "render/lettering.hpp"
#include "render/scene_layers.hpp"

#include <vector>

namespace troupe::render {

/// The floor grid of an oblique view: lines on the floor around the scene, `pitch` metres apart.
SolidLayer solid_grid(const engine::FrameScene& scene, const Projection& projection, double pitch,
                      Rgba color);
/// The distance of grid lines for this view, m.
double grid_pitch(const Projection& projection);

/// Adds the selected overlays on the floor, below the bodies: coverage, density, tiles, cells, bounds,
/// footprints, trails.
void add_on_floor(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                  std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                  const Theme& theme);

/// Adds the selected overlays in the air: scans, beams, sights, blobs. `depth` is `air` in oblique views.
void add_in_air(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                SolidLayer::Depth depth);

/// Adds the selected overlays that connect bodies and that nothing hides: links, grips.
void add_ties(std::vector<AnyLayer>& layers, const engine::Frame& frame, const Projection& projection,
              const Layers& shown, const Theme& theme);

/// The lettering of the picture: names, legends, scale bar and clock.
Writing written(const engine::FrameScene& scene, const engine::Frame& frame, const Projection& projection,
                const Framing& framing, const View& view);

}  // namespace troupe::render
