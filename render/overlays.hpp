#pragma once

#include "render/lettering.hpp"
#include "render/scene_layers.hpp"

#include <vector>

namespace troupe::render {

// Overlays are drawn in addition to the bodies: grid lines, sensor readings, texts and so on. An
// engine::FrameScene has the data to draw that are constant during a run, and an engine::Frame the data of
// one time. The add_ functions append overlays to `layers`, which are in the order of drawing. Each function
// appends only overlays that `shown` selects. `colors` has one colour per body of Frame::mobile; if it is
// empty, bodies have their own colours.

/// Returns the floor grid of a view that is not from above: lines on the floor, at multiples of `pitch` (m).
/// The grid covers the part of scene.bounds within 60 times `pitch` of Projection::origin() along x and y. If
/// scene.bounds are farther away, the grid extends 5 times `pitch` from Projection::origin() in each
/// direction. If scene.bounds are empty, it covers 10 m x 10 m about Projection::origin().
SolidLayer solid_grid(const engine::FrameScene& scene, const Projection& projection, double pitch,
                      Rgba color);
/// Returns the distance between grid lines for a view that is not from above, m: a RoundLength (1, 2 or 5
/// times a power of ten). At Projection::floor_center(), the distance is at least 48 strokes in the picture.
/// If that point is not in front of the viewer, the distance is 2 m. (A stroke is the unit of line widths:
/// Framing::stroke.)
double grid_pitch(const Projection& projection);

/// Appends the overlays on the floor: coverage, density, tiles, cells, bounds, footprints and trails. They
/// cover all earlier layers, and layers that are appended later cover them.
void add_on_floor(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                  std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                  const Theme& theme);

/// Appends the overlays above the floor, which show readings of sensors: scans, beams, sights and blobs.
/// depth: SolidLayer::Depth::floor in a view from above, where the overlays cover all earlier layers;
/// SolidLayer::Depth::air in other views, where nearer static bodies hide them.
void add_in_air(std::vector<AnyLayer>& layers, const engine::FrameScene& scene, const engine::Frame& frame,
                std::span<const Rgba> colors, const Projection& projection, const Layers& shown,
                SolidLayer::Depth depth);

/// Appends the overlays that connect bodies: links and grips. They cover all earlier layers, so the layers of
/// the bodies must have been appended before.
void add_ties(std::vector<AnyLayer>& layers, const engine::Frame& frame, const Projection& projection,
              const Layers& shown, const Theme& theme);

/// Returns the lettering that `view.layers` selects: names, energy bars, legends, the simulated time and the
/// scale. In a view from above, the scale is a scale bar. In other views, it is the distance between grid
/// lines as text, and is omitted without a grid. If Framing::has_furniture() is false because the picture is
/// small, the result has only names and energy bars.
Writing written(const engine::FrameScene& scene, const engine::Frame& frame, const Projection& projection,
                const Framing& framing, const View& view);

}  // namespace troupe::render
