#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::engine {

// The data that a viewer needs to draw one instant. Viewers do not read the engine's tables.

/// A solid to draw.
struct FrameShape {
  Solid solid;                 ///< body frame
  std::optional<Color> color;  ///< not given: that of the body
};

/// The shapes of bodies of one appearance.
struct FrameType {
  std::vector<FrameShape> shapes;  ///< of all parts
  bool mobile = false;             ///< bodies of the type are robots and get a heading mark
  double radius = 0;               ///< of the circle about the body's origin that encloses it, m
  std::string name;                ///< name of the type, for display
};

/// A body to draw.
struct FrameBody {
  std::uint32_t type = 0;  ///< index into FrameScene::types followed by Frame::types
  Pose pose_world_body;    ///< at the instant; static bodies keep it for the whole run
  Color color;             ///< of shapes without a colour
  bool stalled = false;    ///< its last motion was blocked or out of bounds
  std::uint32_t id = 0;    ///< BodyId
};

/// The beams of a ranger that start at one place.
struct FrameTransducer {
  Pose pose_body;           ///< body frame, with joints at rest
  double range_max = 0;     ///< m
  double fov = 0;           ///< from the first beam to the last, rad; the width of a single beam
  std::size_t first = 0;    ///< index of its first reading among those of the ranger
  std::size_t samples = 1;  ///< number of its readings
};

/// A ranger of a type, whose readings can be drawn.
struct FrameRanger {
  std::uint32_t type = 0;                    ///< index into FrameScene::types
  std::size_t readings = 0;                  ///< of all transducers
  std::vector<FrameTransducer> transducers;  ///< together they have all readings
};

/// The data that is constant during a run.
struct FrameScene {
  std::vector<FrameType> types;      ///< by TypeId
  std::vector<FrameBody> fixed;      ///< static bodies
  Box bounds;                        ///< of all bodies at the start, m
  std::string title;                 ///< title of the world
  std::vector<FrameRanger> rangers;  ///< rangers that scans refer to
  double tile_m = 0;                 ///< edge of the tiles of the spatial index; 0: unknown
  double cell_m = 0;                 ///< edge of the cells of the tiles; 0: unknown
  std::optional<Box> limits;         ///< bounds of the world, m; none: not given
};

/// The readings of one ranger.
struct FrameScan {
  std::uint32_t body = 0;    ///< index into Frame::mobile
  std::uint32_t ranger = 0;  ///< index into FrameScene::rangers
  std::size_t first = 0;     ///< index of its first reading in Frame::ranges
  Pose moved;                ///< body frame: displacement of the ranger from its rest pose by joints
};

/// A detection: a line from a sensor to the body it found, world frame, m.
struct FrameSight {
  std::uint32_t body = 0;                          ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< position of the sensor
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< origin of the detected part
};

/// A blob of one colour that a blob finder sees: the triangle from the sensor to both edges, world frame, m.
struct FrameBlob {
  std::uint32_t body = 0;                           ///< index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();   ///< position of the sensor
  Eigen::Vector3d right = Eigen::Vector3d::Zero();  ///< right edge of the blob
  Eigen::Vector3d left = Eigen::Vector3d::Zero();   ///< left edge of the blob
  Color color;                                      ///< colour of the blob
};

/// A line between two related points, world frame, m.
struct FrameTie {
  /// The relation.
  enum class Kind : std::uint8_t {
    carries,      ///< from a carrier to a carried body
    holds,        ///< from a gripper to the body it holds
    beam,         ///< between the paddles of a gripper: uninterrupted
    broken_beam,  ///< between the paddles of a gripper: interrupted
  };
  Kind kind = Kind::carries;                       ///< the relation
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< m, world frame
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< m, world frame
};

/// A square of the floor that robots have visited: [x, x + 1) times [y, y + 1), in units of Frame::covered_m.
struct FrameSquare {
  std::int32_t x = 0;   ///< number of squares east of the origin
  std::int32_t y = 0;   ///< number of squares north of the origin
  float freshness = 1;  ///< time of the last visit: 0 is when watching began, 1 is now
};

/// Past positions of a body.
struct FrameTrail {
  std::uint32_t body = 0;  ///< index into Frame::mobile
  /// World frame, m, from the oldest to now.
  std::vector<Eigen::Vector3d> points;
};

/// One instant: the bodies that may change, and what a viewer requested in addition.
struct Frame {
  double time_s = 0;              ///< world time
  std::uint64_t tick = 0;         ///< ticks done
  std::vector<FrameBody> mobile;  ///< bodies that have a row and are present, by id
  std::vector<FrameType> types;   ///< present shapes of bodies whose parts have moved

  // The following are empty unless the viewer requests them.
  std::vector<FrameScan> scans;      ///< of rangers, by body
  std::vector<float> ranges;         ///< of all scans, m
  std::vector<FrameSight> sights;    ///< of fiducial finders, by body
  std::vector<FrameBlob> blobs;      ///< of blob finders, by body
  std::vector<FrameTie> grips;       ///< beams between paddles, and the bodies that grippers hold
  std::vector<FrameTie> links;       ///< from carriers to carried bodies
  std::vector<FrameTrail> trails;    ///< past positions of bodies
  std::vector<FrameSquare> covered;  ///< squares that robots have visited
  double covered_m = 0;              ///< edge of those squares
  std::vector<std::string> names;    ///< one per body of `mobile`
  std::vector<double> charges;  ///< one per body of `mobile`: charge of its power pack, 0 to 1; NaN: none
  std::vector<double> values;   ///< one per body of `mobile`: value that colours it; NaN: none
  std::string value_name;       ///< name of `values` with unit: "velocity.x (m/s)"
  double times_real_time = 0;   ///< speed relative to real time, displayed with the time; 0: none
};

}  // namespace troupe::engine
