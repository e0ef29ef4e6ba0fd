#pragma once

#include "engine/frame.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace troupe::render {

struct View {
  int width = 1280;
  int height = 720;
  /// What must be seen, world metres: it fills the picture in one direction, and in the other more than it is
  /// seen. Not given: the scene's bounds with a margin.
  std::optional<Box> region;
};

/// 8-bit RGBA, row 0 on top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Draws a frame from above, +x to the right and +y up: floor grid, floor plan, bodies in their colours
/// with a mark at the front of each robot, scale bar, time.
///
/// robots  at least 3.5 pixels wide, so that a swarm stays visible; outlines from 7 pixels on, marks from 9;
///         a red outline when stalled; on top of the floor plan at any height
/// errors  std::runtime_error: no OSMesa (it is opened on first use), with the package to install; a size
///         beyond what the driver draws, with the limit; a region that is not finite or has no size
/// checks  the same bytes for the same input on one machine; the caller's floating-point environment is
///         left as it was; may be called on any thread, on several at once
Picture draw(const engine::FrameScene& scene, const engine::Frame& frame, const View& view);

}  // namespace troupe::render
