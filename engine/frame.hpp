#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::engine {

// What a viewer needs of one instant, as plain data: no viewer reads the engine's tables.

/// A solid to be drawn.
struct FrameShape {
  Solid solid;                 ///< body frame
  std::optional<Color> color;  ///< not given: the body's
};

/// What bodies of one look are drawn as.
struct FrameType {
  std::vector<FrameShape> shapes;  ///< of all parts
  bool mobile = false;             ///< robots get a heading mark
  double radius = 0;               ///< of the circle about the body's origin that encloses it, m
  std::string name;                ///< of the type, for people
};

/// A body to be drawn.
struct FrameBody {
  std::uint32_t type = 0;  ///< index into FrameScene::types; from their number on, into Frame::types
  Pose pose_world_body;    ///< of the instant; of static bodies, for the whole run
  Color color;             ///< of shapes without one of their own
  bool stalled = false;    ///< its last motion was refused
  std::uint32_t id = 0;    ///< BodyId
};

/// Beams that leave from one place: of a ranger of one type.
struct FrameTransducer {
  Pose pose_body;           ///< body frame, with joints at rest
  double range_max = 0;     ///< m
  double fov = 0;           ///< between the first beam and the last, rad; of a single one: how wide it is
  std::size_t first = 0;    ///< of its readings among the ranger's
  std::size_t samples = 1;  ///< how many of them are its
};

/// A ranger of a type, whose readings can be drawn.
struct FrameRanger {
  std::uint32_t type = 0;                    ///< index into FrameScene::types
  std::size_t readings = 0;                  ///< of all transducers
  std::vector<FrameTransducer> transducers;  ///< together they have all readings
};

/// What never changes during a run.
struct FrameScene {
  std::vector<FrameType> types;      ///< by TypeId
  std::vector<FrameBody> fixed;      ///< static bodies
  Box bounds;                        ///< of everything at the start, m
  std::string title;                 ///< of the world
  std::vector<FrameRanger> rangers;  ///< those that some scan may be of
  double tile_m = 0;          ///< edge of the tiles of the index, and of the cells in them; 0: not known
  double cell_m = 0;          ///< see `tile_m`
  std::optional<Box> limits;  ///< where robots may go, m; none: the world does not say
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
  std::uint32_t body = 0;                          ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< where the sensor is
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< the origin of what it found
};

/// A stretch of one colour that a blob finder sees, as the triangle from its eye to both ends, world frame,
/// m.
struct FrameBlob {
  std::uint32_t body = 0;                           ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();   ///< its eye
  Eigen::Vector3d right = Eigen::Vector3d::Zero();  ///< where the stretch ends on its right
  Eigen::Vector3d left = Eigen::Vector3d::Zero();   ///< where it ends on its left
  Color color;                                      ///< that it sees
};

/// A line between two things that belong together, world frame, m.
struct FrameTie {
  /// What belongs together.
  enum class Kind : std::uint8_t {
    carries,      ///< from a carrier to what it carries
    holds,        ///< from a gripper to what it holds
    beam,         ///< between its paddles: nothing is in the way
    broken_beam,  ///< something is
  };
  Kind kind = Kind::carries;                       ///< decides how it is drawn
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< m, world frame
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< m, world frame
};

/// A square of the floor on which robots have been: [x, x + 1) times [y, y + 1) edges.
struct FrameSquare {
  std::int32_t x = 0;   ///< edges east of the origin
  std::int32_t y = 0;   ///< edges north of it
  float freshness = 1;  ///< from 0, when watching began, to 1, now: when a robot was there last
};

/// Where a body was before.
struct FrameTrail {
  std::uint32_t body = 0;  ///< index into Frame::mobile
  /// World frame, m, from the oldest to now.
  std::vector<Eigen::Vector3d> points;
};

/// One instant: what moves, and what was asked for beside it.
struct Frame {
  double time_s = 0;              ///< world time
  std::uint64_t tick = 0;         ///< ticks done
  std::vector<FrameBody> mobile;  ///< bodies that have a row and are there, by id
  std::vector<FrameType> types;   ///< of bodies of which parts have moved: as they look now

  // What a viewer asked for beside the bodies; else empty.
  std::vector<FrameScan> scans;      ///< of rangers, by body
  std::vector<float> ranges;         ///< of all scans, m
  std::vector<FrameSight> sights;    ///< by fiducial finders, by body
  std::vector<FrameBlob> blobs;      ///< of blob finders, by body
  std::vector<FrameTie> grips;       ///< beams between paddles, and what grippers hold
  std::vector<FrameTie> links;       ///< from carriers to what they carry
  std::vector<FrameTrail> trails;    ///< the ways of bodies
  std::vector<FrameSquare> covered;  ///< the floor that was covered
  double covered_m = 0;              ///< edge of those squares
  std::vector<std::string> names;    ///< beside `mobile`
  std::vector<double> charges;       ///< beside `mobile`: share that its power pack holds; NaN: it has none
  std::vector<double> values;        ///< beside `mobile`: what bodies are coloured by; NaN: it has none
  std::string value_name;            ///< with its unit: "velocity.x (m/s)"
  double times_real_time = 0;        ///< what the clock tells beside the time; 0: nothing
};

}  // namespace troupe::engine
