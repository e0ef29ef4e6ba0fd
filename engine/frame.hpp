#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"

#include <cstddef>
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
  std::uint32_t id = 0;  ///< BodyId
};

/// Beams that leave from one place: of a ranger of one type.
struct FrameTransducer {
  Pose pose_body;         ///< body frame
  double range_max = 0;   ///< m
  double fov = 0;         ///< between the first beam and the last, rad; of a single one: how wide it is
  std::size_t first = 0;  ///< of its readings among the ranger's
  std::size_t samples = 1;
};

struct FrameRanger {
  std::uint32_t type = 0;  ///< index into FrameScene::types
  std::size_t readings = 0;
  std::vector<FrameTransducer> transducers;
};

/// What never changes during a run.
struct FrameScene {
  std::vector<FrameType> types;
  std::vector<FrameBody> fixed;
  Box bounds;  ///< of everything at the start, m
  std::string title;
  std::vector<FrameRanger> rangers;
  double tile_m = 0;  ///< edge of the tiles of the index, and of the cells in them; 0: not known
  double cell_m = 0;
};

/// What one ranger reads.
struct FrameScan {
  std::uint32_t body = 0;    ///< index into Frame::mobile
  std::uint32_t ranger = 0;  ///< index into FrameScene::rangers
  std::size_t first = 0;     ///< of its readings: index into Frame::ranges
};

/// Who sees whom: from one body's sensor to what it found, world frame, m.
struct FrameSight {
  std::uint32_t body = 0;  ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
};

/// Where a body was before.
struct FrameTrail {
  std::uint32_t body = 0;  ///< index into Frame::mobile
  /// World frame, m, from the oldest to now.
  std::vector<Eigen::Vector3d> points;
};

struct Frame {
  double time_s = 0;
  std::uint64_t tick = 0;
  std::vector<FrameBody> mobile;
  std::vector<FrameType> types;  ///< of bodies of which parts have moved: as they look now

  // What a viewer asked for beside the bodies; else empty.
  std::vector<FrameScan> scans;
  std::vector<float> ranges;  ///< of all scans, m
  std::vector<FrameSight> sights;
  std::vector<FrameTrail> trails;
  std::vector<std::string> names;  ///< beside `mobile`
  std::vector<double> charges;     ///< beside `mobile`: share that its power pack holds; NaN: it has none
  std::vector<double> values;      ///< beside `mobile`: what bodies are coloured by; NaN: it has none
  std::string value_name;          ///< with its unit: "velocity.x (m/s)"
};

}  // namespace troupe::engine
