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
  Pose pose_body;         ///< body frame, with joints at rest
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
  Pose moved;  ///< body frame: takes the ranger from where it rests to where joints have carried it
};

/// Who sees whom: from one body's sensor to what it found, world frame, m.
struct FrameSight {
  std::uint32_t body = 0;  ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
};

/// A stretch of one colour that a blob finder sees, as the triangle from its eye to both ends, world frame,
/// m.
struct FrameBlob {
  std::uint32_t body = 0;  ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  Color color;
};

/// A line between two things that belong together, world frame, m.
struct FrameTie {
  enum class Kind : std::uint8_t {
    carries,      ///< from a carrier to what it carries
    holds,        ///< from a gripper to what it holds
    beam,         ///< between its paddles: nothing is in the way
    broken_beam,  ///< something is
  };
  Kind kind = Kind::carries;
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
};

/// A square of the floor on which robots have been: [x, x + 1) times [y, y + 1) edges.
struct FrameSquare {
  std::int32_t x = 0;
  std::int32_t y = 0;
  float freshness = 1;  ///< from 0, when watching began, to 1, now: when somebody was there last
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
  std::vector<FrameBlob> blobs;
  std::vector<FrameTie> grips;
  std::vector<FrameTie> links;
  std::vector<FrameTrail> trails;
  std::vector<FrameSquare> covered;
  double covered_m = 0;            ///< edge of those squares
  std::vector<std::string> names;  ///< beside `mobile`
  std::vector<double> charges;     ///< beside `mobile`: share that its power pack holds; NaN: it has none
  std::vector<double> values;      ///< beside `mobile`: what bodies are coloured by; NaN: it has none
  std::string value_name;          ///< with its unit: "velocity.x (m/s)"
  double times_real_time = 0;      ///< what the clock tells beside the time; 0: nothing
};

}  // namespace troupe::engine
