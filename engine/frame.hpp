#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::engine {

// The data that a viewer needs to draw a world at one tick. Viewers do not read the state tables.

/// A solid to draw.
struct FrameShape {
  Solid solid;                 ///< its geometry in the body frame
  std::optional<Color> color;  ///< colour of the solid; not set: FrameBody::color
};

/// The shapes of bodies that look alike.
struct FrameType {
  std::vector<FrameShape> shapes;  ///< the solids of all parts
  bool mobile = false;             ///< true: the bodies are robots and get a mark that shows their heading
  double radius = 0;               ///< radius of the circle about the body's origin that encloses it, m
  std::string name;                ///< name of the type, for display
};

/// A body to draw.
struct FrameBody {
  std::uint32_t type = 0;  ///< index into FrameScene::types; larger indices continue in Frame::types
  Pose pose_world_body;    ///< pose at this tick; for static bodies, the pose during the whole run
  Color color;             ///< colour of the shapes that have no colour of their own
  bool stalled = false;    ///< whether its last motion was blocked or would have ended out of bounds
  std::uint32_t id = 0;    ///< id of the body (BodyId)
};

/// The beams of a ranger that start at one place.
struct FrameTransducer {
  Pose pose_body;           ///< origin of the beams and heading of their middle; body frame, joints at rest
  double range_max = 0;     ///< length of the beams, m
  double fov = 0;           ///< angle from the first beam to the last, rad; width of the beam if it is single
  std::size_t first = 0;    ///< index of its first reading among those of the ranger
  std::size_t samples = 1;  ///< number of its readings
};

/// A ranger of a type, whose readings can be drawn.
struct FrameRanger {
  std::uint32_t type = 0;                    ///< type of the body: index into FrameScene::types
  std::size_t readings = 0;                  ///< number of readings of all transducers
  std::vector<FrameTransducer> transducers;  ///< each reading belongs to exactly one of them
};

/// The data that are constant during a run.
struct FrameScene {
  std::vector<FrameType> types;      ///< body types, indexed by TypeId
  std::vector<FrameBody> fixed;      ///< static bodies
  Box bounds;                        ///< box that contains all bodies at tick 0, m
  std::string title;                 ///< title of the world
  std::vector<FrameRanger> rangers;  ///< rangers that FrameScan refers to
  double tile_m = 0;                 ///< edge of the tiles of the spatial index, m; 0: unknown
  double cell_m = 0;                 ///< edge of the cells of those tiles, m; 0: unknown
  std::optional<Box> limits;         ///< bounds of the world (WorldSpec::bounds), m
};

/// The readings of one ranger of one body.
struct FrameScan {
  std::uint32_t body = 0;    ///< the body: index into Frame::mobile
  std::uint32_t ranger = 0;  ///< the ranger: index into FrameScene::rangers
  std::size_t first = 0;     ///< index of its first reading in Frame::ranges
  Pose moved;                ///< displacement of the ranger by joints, relative to rest, body frame
};

/// A detection: a line from a sensor to the part that it detected, world frame, m.
struct FrameSight {
  std::uint32_t body = 0;                          ///< the body: index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< position of the sensor
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< origin of the detected part
};

/// A blob of one colour that a blob finder sees. It is drawn as a triangle between the sensor and the two
/// edges of the blob, world frame, m.
struct FrameBlob {
  std::uint32_t body = 0;                           ///< the body: index into Frame::mobile
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
    beam,         ///< a light beam between the paddles of a gripper, not interrupted
    broken_beam,  ///< a light beam between the paddles of a gripper, interrupted by a body
  };
  Kind kind = Kind::carries;                       ///< which relation the line shows
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< one end, world frame, m
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< other end, world frame, m
};

/// A square of the floor that robots have visited. It is [x, x + 1) times [y, y + 1) in the world frame, in
/// units of Frame::covered_m.
struct FrameSquare {
  std::int32_t x = 0;   ///< lower edge in x, in units of Frame::covered_m
  std::int32_t y = 0;   ///< lower edge in y, in units of Frame::covered_m
  float freshness = 1;  ///< time of the last visit, from 0 (the viewer's first tick) to 1 (now)
};

/// Past positions of a body.
struct FrameTrail {
  std::uint32_t body = 0;  ///< the body: index into Frame::mobile
  /// Positions from the oldest to the present one, world frame, m.
  std::vector<Eigen::Vector3d> points;
};

/// The data that change with each tick: the bodies that are not static, and further data that the viewer
/// requests.
struct Frame {
  double time_s = 0;              ///< world time, s
  std::uint64_t tick = 0;         ///< number of completed ticks
  std::vector<FrameBody> mobile;  ///< the bodies that are in the world and not static, in order of ids
  std::vector<FrameType> types;   ///< one per body whose joints are not at rest: its present shapes

  // The following are empty unless the viewer requests them.
  std::vector<FrameScan> scans;      ///< scans of rangers, in order of bodies
  std::vector<float> ranges;         ///< ranges of all scans, one after another, m
  std::vector<FrameSight> sights;    ///< detections of fiducial finders, in order of bodies
  std::vector<FrameBlob> blobs;      ///< blobs that blob finders see, in order of bodies
  std::vector<FrameTie> grips;       ///< beams between paddles, and the bodies that grippers hold
  std::vector<FrameTie> links;       ///< lines from carriers to carried bodies
  std::vector<FrameTrail> trails;    ///< past positions of bodies
  std::vector<FrameSquare> covered;  ///< squares that robots have visited
  double covered_m = 0;              ///< edge of the squares of `covered`, m
  std::vector<std::string> names;    ///< names of bodies, one per body of `mobile`
  std::vector<double> charges;  ///< one per body of `mobile`: charge of its power pack, 0 to 1; NaN: none
  /// One per body of `mobile`: value of a field of the state that selects the body's colour; NaN: none.
  std::vector<double> values;
  std::string value_name;  ///< name of `values` with unit: "velocity.x (m/s)"
  /// Speed of the run relative to real time, which the viewer displays; 0: not displayed.
  double times_real_time = 0;
};

}  // namespace troupe::engine
