#pragma once

#include "render/lettering.hpp"
#include "render/scene_layers.hpp"

#include <vector>

namespace troupe::render {

// Overlays are drawn in addition to the bodies: grid lines, sensor readings, texts and so on. An
// engine::FrameScene has the data to draw that are constant during a run, and an engine::Frame the data of
// one time. The add_ functions append overlays to `layers`, which are in the order of drawing. Each function
// appends only overlays that Content::layers selects.

/// The part of the floor that the grid of solid_grid() covers, world frame, m: the part of scene.bounds
/// within 60 times `pitch` of Projection::floor_center() along x and y. If that point is in the middle of the
/// picture and outside of scene.bounds, for example because the camera follows a robot, the grid also extends
/// 15 times `pitch` from it in each direction. In a level view from far outside of scene.bounds, the grid
/// extends only 5 times `pitch` in each direction.
Box grid_box(const engine::FrameScene& scene, const Projection& projection, double pitch);
/// Returns the floor grid of a view that is not from above: lines on the floor, at multiples of `pitch` (m),
/// that cover grid_box().
SolidLayer solid_grid(const engine::FrameScene& scene, const Projection& projection, double pitch,
                      Rgba color);
/// Returns the distance between grid lines for a view that is not from above, m: a RoundLength (1, 2 or 5
/// times a power of ten). At Projection::floor_center(), the distance is at least 48 strokes in the picture.
/// If that point is not in front of the viewer, the distance is 2 m. (A stroke is the unit of line widths:
/// Framing::stroke.)
double grid_pitch(const Projection& projection);

/// Appends the overlays on the floor: coverage, density, tiles, cells, bounds, footprints and trails. They
/// cover all earlier layers, and layers that are appended later cover them.
void add_on_floor(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection);

/// Appends the overlays above the floor, which show readings of sensors: scans, beams, sights and blobs.
/// depth: SolidLayer::Depth::floor in a view from above, where the overlays cover all earlier layers;
/// SolidLayer::Depth::air in other views, where nearer static bodies hide them.
void add_in_air(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection,
                SolidLayer::Depth depth);

/// Appends the overlays that connect bodies: links and grips. They cover all earlier layers, so the layers of
/// the bodies must have been appended before.
void add_ties(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection);

/// Returns the lettering that `view.layers` selects: names, energy bars, legends, the simulated time and the
/// scale. In a view from above, the scale is a scale bar. In other views, it is the distance between grid
/// lines as text, and is omitted without a grid. If Framing::has_furniture() is false because the picture is
/// small, the result has only names and energy bars.
Writing written(const engine::FrameScene& scene, const engine::Frame& frame, const Projection& projection,
                const Framing& framing, const View& view);

}  // namespace troupe::render
