#pragma once

#include "engine/frame.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace troupe::render {

struct View {
  int width = 1280;
  int height = 720;
  /// What must be seen, world metres; not given: the scene's bounds.
  std::optional<Box> region;
};

/// 8-bit RGBA, row 0 on top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Draws a frame from above: floor plan, bodies in their colours, a mark at the front of each robot.
/// Opens OSMesa on first use; throws std::runtime_error with the package to install where it is missing, or
/// with the limit when the size is beyond what the driver draws.
Picture draw(const engine::FrameScene& scene, const engine::Frame& frame, const View& view);

}  // namespace troupe::render
