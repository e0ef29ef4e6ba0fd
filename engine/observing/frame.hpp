#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

// The data that a viewer needs to draw a world at one tick (time step). Viewers do not read the state of the
// world itself. A FrameScene has the data that are constant during a run, and a Frame the data that change
// from tick to tick.
//
// A body consists of parts, and a part of solids. The first part is the root part. A part can be mounted on a
// joint, which a device moves; a joint is at rest in the pose that the body type defines. A static body does
// not move during a run. A ranger is a sensor that measures distances along beams. Each of its transducers
// emits one fan of beams.

/// A solid to draw.
struct FrameShape {
  Solid solid;                 ///< its geometry, body frame, m
  std::optional<Color> color;  ///< colour of the solid; not set: the colour of its body (FrameBody::color)
};

/// Returns the radius of the smallest circle about the body's origin that encloses all shapes, m; 0 if there
/// are no shapes.
inline double enclosing_radius(std::span<const FrameShape> shapes) {
  double radius = 0;
  for (const FrameShape& shape : shapes)
    for (const Ring& ring : shape.solid.contours)
      for (const Vec2& point : ring) radius = std::max(radius, point.norm());
  return radius;
}

/// The shapes and colours with which bodies are drawn. FrameScene::types has one element per body type.
/// Frame::types has the elements for bodies that now look different from their type, because joints have
/// moved or parts were recoloured.
struct FrameType {
  std::vector<FrameShape> shapes;  ///< the solids of all parts
  bool mobile = false;             ///< true: the bodies are robots (have a drive); a mark shows their heading
  double radius = 0;               ///< enclosing_radius() of `shapes`, m
  std::string name;                ///< name of the type, for display
};

/// A body to draw.
struct FrameBody {
  /// Index of the FrameType of the body. With n elements in FrameScene::types, an index i below n refers to
  /// FrameScene::types[i], and an index i of n or more refers to Frame::types[i - n]. For static bodies, the
  /// index is below n.
  std::uint32_t type = 0;
  Pose pose_world_body;  ///< pose at this tick; for static bodies, the pose during the whole run
  Color color;           ///< colour of the shapes that have no colour of their own
  bool stalled = false;  ///< whether its last motion was blocked or out of bounds; false for static bodies
  std::uint32_t id = 0;  ///< number of the body in the world: the value of its BodyId
};

/// A transducer of a ranger: a fan of beams that all start at the same point.
struct FrameTransducer {
  Pose pose_body;           ///< origin and middle direction of the beams; body frame, joints at rest
  double range_max = 0;     ///< length of the beams, m
  double fov = 0;           ///< angle from the first beam to the last, rad; for a single beam, its width
  std::size_t first = 0;    ///< index of the fan's first reading among the readings of the ranger
  std::size_t samples = 1;  ///< number of readings of the fan
};

/// A ranger of a body type, whose readings (measured distances) can be drawn.
struct FrameRanger {
  std::uint32_t type = 0;    ///< type of the body: index into FrameScene::types
  std::size_t readings = 0;  ///< number of readings of all transducers
  /// The transducers of the ranger. Each reading belongs to exactly one transducer.
  std::vector<FrameTransducer> transducers;
};

/// The data that are constant during a run.
struct FrameScene {
  std::vector<FrameType> types;  ///< body types, indexed by TypeId
  std::vector<FrameBody> fixed;  ///< static bodies, in order of ids
  /// Box that contains all static bodies, and the bounding circles of all other bodies that are in the world
  /// at tick 0; m, world frame.
  Box bounds;
  std::string title;                 ///< title of the world
  std::vector<FrameRanger> rangers;  ///< the rangers of all body types
  /// Edge of the square tiles into which the spatial index of bodies is divided, m; 0: unknown.
  double tile_m = 0;
  double cell_m = 0;  ///< edge of the square cells into which a tile is divided, m; 0: unknown
  /// Box that the origins of bodies cannot leave (WorldSpec::bounds), m, world frame. Not set: the world file
  /// gives none.
  std::optional<Box> limits;
};

/// The readings of one ranger of one body: consecutive elements of Frame::ranges. Their number is
/// FrameRanger::readings.
struct FrameScan {
  std::uint32_t body = 0;    ///< the body: index into Frame::mobile
  std::uint32_t ranger = 0;  ///< the ranger: index into FrameScene::rangers
  std::size_t first = 0;     ///< index of its first reading in Frame::ranges
  /// How joints have moved the ranger: the motion from its pose with joints at rest to its present pose, body
  /// frame, m and rad. The identity if the ranger is on no joint.
  Pose moved;
};

/// A detection by a fiducial finder (a sensor that detects marked parts of bodies): a line from the sensor to
/// the part that it detected, world frame, m.
struct FrameSight {
  std::uint32_t body = 0;                          ///< the body: index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< position of the sensor
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< origin of the part when it was detected
};

/// A blob that a blob finder (a sensor) sees: a region of one colour in its view. It is drawn as a triangle
/// between the sensor and the two edges of the blob. Positions are in the world frame, m.
struct FrameBlob {
  std::uint32_t body = 0;                           ///< the body: index into Frame::mobile
  Eigen::Vector3d from = Eigen::Vector3d::Zero();   ///< position of the sensor
  Eigen::Vector3d right = Eigen::Vector3d::Zero();  ///< right edge of the blob
  Eigen::Vector3d left = Eigen::Vector3d::Zero();   ///< left edge of the blob
  Color color;                                      ///< colour of the blob
};

/// A line between two related points, world frame, m.
struct FrameTie {
  /// The relation between the two points.
  enum class Kind : std::uint8_t {
    carries,      ///< from the origin of a body to the origin of a body that it carries
    holds,        ///< from a gripper to the origin of the body that it holds
    beam,         ///< a light beam between the paddles of a gripper, not interrupted
    broken_beam,  ///< a light beam between the paddles of a gripper, interrupted by a body
  };
  Kind kind = Kind::carries;                       ///< the relation
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< one end, world frame, m
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< other end, world frame, m
};

/// A square of the floor that the origin of a robot has visited: [x, x + 1) times [y, y + 1) in the world
/// frame, in units of Frame::covered_m.
struct FrameSquare {
  std::int32_t x = 0;  ///< lower edge in x, in units of Frame::covered_m
  std::int32_t y = 0;  ///< lower edge in y, in units of Frame::covered_m
  /// Time of the last visit to the square, as a number from 0 to 1. 0 is the first tick that the viewer has
  /// stored, and 1 is the last.
  float freshness = 1;
};

/// Past positions of a body. The viewer chooses how far they go back in time.
struct FrameTrail {
  std::uint32_t body = 0;  ///< the body: index into Frame::mobile
  /// Positions of the body's origin in order of time, world frame, m. The last one is the present position.
  /// The list has at least one element.
  std::vector<Eigen::Vector3d> points;
};

/// The data that change from tick to tick: the bodies that are not static, and further data that the viewer
/// requests.
struct Frame {
  double time_s = 0;              ///< simulated time, s
  std::uint64_t tick = 0;         ///< number of completed ticks
  std::vector<FrameBody> mobile;  ///< bodies that are in the world and not static, in order of ids
  /// Shapes of bodies that now look different from their type, because a joint is not at rest or a device has
  /// set the colour of a part. FrameBody::type refers to them. Bodies of one type that look alike may share
  /// an element. The colour of the root part is not stored here, but in FrameBody::color.
  std::vector<FrameType> types;

  // The following are empty unless the viewer requests them.
  /// Readings of rangers, in any order. A ranger that does not run, for example because no controller uses
  /// it, has no entry. The list is empty at tick 0, because no ranger has run yet.
  std::vector<FrameScan> scans;
  std::vector<float> ranges;       ///< ranges of all scans, one after another, m
  std::vector<FrameSight> sights;  ///< detections of fiducial finders, in order of bodies
  std::vector<FrameBlob> blobs;    ///< blobs that blob finders see, in order of bodies
  /// Light beams between the paddles of grippers, and lines to the bodies that grippers hold, in order of
  /// bodies.
  std::vector<FrameTie> grips;
  std::vector<FrameTie> links;     ///< lines from carriers to carried bodies, in order of the carried bodies
  std::vector<FrameTrail> trails;  ///< past positions, one per body of `mobile`, in the same order
  std::vector<FrameSquare> covered;  ///< squares that robots have visited, sorted by x and then by y
  double covered_m = 0;              ///< edge of the squares of `covered`, m
  std::vector<std::string> names;    ///< names of bodies, one per body of `mobile`
  /// One per body of `mobile`: energy of the first device of the body that stores energy
  /// (DeviceKind::energy), such as a power pack. The energy is given as a fraction of the capacity, 0 to 1.
  /// The value is 1 if the device never becomes empty, and NaN if the body has no such device.
  std::vector<double> charges;
  /// One per body of `mobile`: the value by which the viewer colours the body, taken from one field of the
  /// state. NaN: the body has no such value.
  std::vector<double> values;
  /// Name of the field of `values`, with its unit, for display: "velocity.x (m/s)".
  std::string value_name;
  /// Speed of the run relative to real time, which the viewer displays; 0: not displayed.
  double times_real_time = 0;
};

class World;

/// Returns the data for drawing a world that do not change during a run. FrameScene::rangers (the rangers
/// whose beams can be drawn) is empty.
FrameScene make_scene(const World& world);
/// Returns the data for drawing a world that change with each tick. The members Frame::time_s, `tick`,
/// `mobile` and `types` are set. All other members are empty. Throws std::logic_error if the last step threw
/// (World::require_whole()).
Frame make_frame(const World& world);

}  // namespace troupe::engine
