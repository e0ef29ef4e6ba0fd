#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::engine {

/// What a viewer needs of one instant, as plain data: no viewer reads the engine's tables.

struct FrameShape {
  Solid solid;                 ///< body frame
  std::optional<Color> color;  ///< not given: the body's
};

struct FrameType {
  std::vector<FrameShape> shapes;
  bool mobile = false;  ///< robots get a heading mark
  double radius = 0;    ///< of the circle about the body's origin that encloses it, m
};

struct FrameBody {
  std::uint32_t type = 0;  ///< index into FrameScene::types; from their number on, into Frame::types
  Pose pose_world_body;
  Color color;
  bool stalled = false;
};

/// What never changes during a run.
struct FrameScene {
  std::vector<FrameType> types;
  std::vector<FrameBody> fixed;
  Box bounds;  ///< of everything at the start, m
  std::string title;
};

struct Frame {
  double time_s = 0;
  std::uint64_t tick = 0;
  std::vector<FrameBody> mobile;
  std::vector<FrameType> types;  ///< of bodies of which parts have moved: as they look now
};

}  // namespace troupe::engine
