#pragma once

#include "render/lettering.hpp"
#include "render/scene_layers.hpp"

#include <vector>

namespace troupe::render {

/// Returns the floor grid of a view that is not from above: lines on the floor, `pitch` metres apart, at
/// multiples of `pitch`. The grid covers scene.bounds (if these are empty, 10 m x 10 m about
/// Projection::origin()), but only up to 60 lines from Projection::origin() in each direction. If no part of
/// the bounds is that near, the grid extends 5 lines from Projection::origin() in each direction. scene: the
/// data to draw that are constant during a run; in the functions below, `frame` has those that change.
SolidLayer solid_grid(const engine::FrameScene& scene, const Projection& projection, double pitch,
                      Rgba color);
/// The distance between grid lines for this view, m: 1, 2 or 5 times a power of ten (RoundLength). At
/// Projection::floor_center(), this distance is at least 48 strokes long in the picture. (A stroke is the
/// unit of line widths, Framing::stroke.) If Projection::floor_center() is behind the viewer, the distance is
/// 2 m.
double grid_pitch(const Projection& projection);

/// Appends layers (meshes with their positions) with those overlays on the floor that `shown` selects:
/// coverage, density, tiles, cells, bounds, footprints, trails. The new layers cover all earlier layers, and
/// later layers cover them. colors: one colour per body of Frame::mobile; if empty, bodies have their own
/// colours.
void add_on_floor(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                  std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                  const Theme& theme);

/// Appends layers with those overlays above the floor that `shown` selects, which show readings of sensors:
/// scans, beams, sights, blobs. colors: one colour per body of Frame::mobile; if empty, bodies have their own
/// colours. depth: how these layers use the depth buffer: `floor` in a view from above, `air` in other views.
void add_in_air(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                SolidLayer::Depth depth);

/// Appends a layer with those overlays that connect bodies and that `shown` selects: links, grips. The layer
/// covers all earlier layers, so it must come after the bodies.
void add_ties(std::vector<AnyLayer>& layers, const engine::Frame& frame, const Projection& projection,
              const Layers& shown, const Theme& theme);

/// The lettering that `view.layers` selects for the picture: names, energy bars, legends, the simulated time,
/// and the scale bar or, in a view that is not from above and has a grid, the distance between grid lines. A
/// picture for which Framing::has_furniture() is false, because it is small, has only names and energy bars.
Writing written(const engine::FrameScene& scene, const engine::Frame& frame, const Projection& projection,
                const Framing& framing, const View& view);

}  // namespace troupe::render
