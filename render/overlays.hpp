#pragma once

#include "render/lettering.hpp"
#include "render/scene_layers.hpp"

#include <vector>

namespace troupe::render {

/// The floor grid of a view that is not from above: lines on the floor around what is shown. `pitch` is how
/// far apart they are, m.
SolidLayer solid_grid(const engine::FrameScene& scene, const Projection& projection, double pitch,
                      Rgba color);
/// How far apart they should be for this view, m.
double grid_pitch(const Projection& projection);

/// What lies on the floor below the bodies, as the layers ask for it: coverage, density, tiles, cells,
/// bounds, footprints, trails.
void add_on_floor(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                  std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                  const Theme& theme);

/// What is drawn into the air: scans, beams, sights, blobs. `depth` is air where bodies hide one another.
void add_in_air(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                SolidLayer::Depth depth);

/// What joins bodies, and is seen through everything: links, grips.
void add_ties(std::vector<AnyLayer>& layers, const engine::Frame& frame, const Projection& projection,
              const Layers& shown, const Theme& theme);

/// What is written on the picture: names, the legends, the scale bar and the clock.
Writing written(const engine::FrameScene& scene, const engine::Frame& frame, const Projection& projection,
                const Framing& framing, const View& view);

}  // namespace troupe::render
