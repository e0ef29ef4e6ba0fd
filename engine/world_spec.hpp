#pragma once

#include "base/color.hpp"
#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/experiment_spec.hpp"
#include "engine/fields.hpp"
#include "engine/measure_spec.hpp"
#include "engine/names.hpp"
#include "engine/ranging_engine.hpp"
#include "engine/watch_spec.hpp"

#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace troupe::engine {

// The expanded contents of a world file: plain data that a loader makes from any format, that a program can
// fill by hand, and that engine::World is built from. Lengths in metres, angles in radians, times in seconds.

/// Most corners that the outlines of a world may have: all its types together, and all its static bodies
/// together.
inline constexpr std::size_t k_most_vertices = 50000000;

/// How a model interacts with other bodies and with their sensors.
struct Returns {
  bool obstacle = true;           ///< takes part in collisions
  float ranger = 1;               ///< intensity that a ranger reads; below 0: its rays pass through
  std::int32_t fiducial = 0;      ///< value that fiducial finders read; 0: they do not find it
  std::int32_t fiducial_key = 0;  ///< only finders with this key find it
  bool gripper = false;           ///< grippers detect it and can grip it
  bool pushable = false;          ///< robots can push the whole body: docs/pushing.md
  bool blob = true;               ///< blob finders see its colour; false: it only occludes
  friend bool operator==(const Returns&, const Returns&) = default;
};

/// In place of the index of a joint: rigidly attached to the body.
inline constexpr std::int32_t k_rigid = -1;

/// A frame of a type that one of its devices moves: an actuator, or a paddle of a gripper. Poses of parts,
/// devices and further joints on it are given with every joint at rest.
struct JointSpec {
  std::string name;               ///< its component is `joint/<name>`
  std::int32_t parent = k_rigid;  ///< index of the joint that it is mounted on; lower than its own
  Pose pose_body_joint;           ///< at rest; the joint moves in this frame
};

/// The image that a part's solids are made from. Only writers of worlds need it: the solids hold all else.
struct ImageSpec {
  std::string file;               ///< path of the image; for a ROS map, of its YAML file
  bool keeps_margins = false;     ///< the whole image is scaled to the part's size, not only its solid area
  bool unknown_is_solid = false;  ///< ROS map: unknown cells are solid
  bool boundary = false;          ///< adds four walls just inside its edges
  Pose origin;                    ///< centre of the image, or frame of the map, in the part's frame
  friend bool operator==(const ImageSpec&, const ImageSpec&) = default;
};

/// The blocks that a part's solids are made from, as in Stage: scaled together to fill the part's size,
/// centred in x and y, and placed at `origin` in the part's frame. Only writers of worlds need it.
struct FittedBlocks {
  std::vector<Solid> blocks;  ///< in a common frame, in any unit of length
  Pose origin;                ///< pose of their centre
};

/// One model of a type's tree.
struct PartSpec {
  std::string name;              ///< relative to the body's name: "ranger:0"; empty for the root (part 0)
  std::string alias;             ///< its generated name if the world gives it another; else empty
  std::string kind;              ///< model kind: "position", "ranger", ...
  std::uint32_t parent = 0;      ///< index of its parent part; the root's is 0
  std::int32_t joint = k_rigid;  ///< index of the joint that moves it
  Pose pose_body_part;           ///< pose of the part's frame
  Eigen::Vector3d size{0.4, 0.4, 1.0};  ///< as declared; GetGeom returns it in Stage
  std::vector<Solid> solids;            ///< in the body's frame, scaled, also in z
  Returns returns;                      ///< how it interacts with other bodies
  bool floor_plan = false;              ///< its outline comes from an image
  std::optional<ImageSpec> image;       ///< source of its solids; not set: no image
  std::optional<FittedBlocks> fitted;   ///< source of its solids; not set: they are used as given
  std::optional<Color> color;           ///< not set: the body's colour
  Where where;                          ///< for messages
};

/// A device that each body of a type carries.
struct DeviceSpec {
  std::string name;              ///< that of its part, unless the type gives it another
  std::string kind;              ///< a kind of Registry::devices
  std::uint32_t part = 0;        ///< index of the part that carries it
  std::int32_t joint = k_rigid;  ///< index of the joint that it is mounted on
  std::int32_t moves = k_rigid;  ///< index of the first joint that it moves (DeviceKind::joints)
  Record params;                 ///< one value for each field of the kind's table
  Pose pose_body_device;         ///< frame in which the kind's parameters are given
  double period_s = 0;           ///< 0: every tick
  bool active = true;            ///< true: runs without a subscriber
  Where where;                   ///< for messages
};

/// The drive of the bodies of a type.
struct DriveSpec {
  std::string kind;     ///< a kind of Registry::drives
  Record params;        ///< one value for each field of the kind's table: FieldTable::defaults()
  double period_s = 0;  ///< 0: every tick
  Where where;          ///< for messages
};

/// A controller of the bodies of a type.
struct ControllerSpec {
  std::string kind;        ///< a kind of Registry::controllers or of a plug-in
  std::uint32_t part = 0;  ///< index of its part: it uses the devices of that part and of the parts on it
  Record params;           ///< one value for each field of the kind's table: FieldTable::defaults()
  double period_s = 0;     ///< used if it reads no sensor and has no drive; 0: every tick
  Where where;             ///< for messages
};

/// A body type: everything that identical bodies share.
struct TypeSpec {
  std::string name;                         ///< unique in the world
  std::vector<PartSpec> parts;              ///< depth first; part 0 is the root
  std::vector<JointSpec> joints;            ///< each after its parent joint
  std::optional<DriveSpec> drive;           ///< not set: the bodies have no drive
  std::vector<DeviceSpec> devices;          ///< a device that moves a joint comes before the devices on it
  std::vector<ControllerSpec> controllers;  ///< in the order in which they decide: the last command counts
};

/// One body of the world.
struct BodySpec {
  Name name;             ///< made of the words of WorldSpec::names
  TypeId type;           ///< index into WorldSpec::types
  Pose pose_world_body;  ///< at tick 0, with all joints at rest
  Color color;           ///< colour of the parts that set none
  /// Replaces Returns::fiducial of the root part if that is not 0, so that robots with different fiducial
  /// values can share a type. 0: the type's value.
  std::int32_t fiducial = 0;
  Where where;  ///< for messages
};

/// Bodies of a population that are unborn at tick 0: [first, first + count), born one after another
/// (docs/lives.md). All are of one type. Their poses are given at birth.
struct ReserveSpec {
  std::string population;   ///< its population: NAME of NAME0, NAME1, ...
  BodyId first;             ///< lowest id of the reserve
  std::uint32_t count = 0;  ///< number of bodies in the reserve
};

/// A part to which the world gives a name that is independent of its body's name.
struct PartName {
  BodyId body;       ///< the body that has the part
  std::string part;  ///< PartSpec::name
};

/// The recording that the world asks for (docs/recordings.md).
struct RecordSpec {
  std::string file;                 ///< path; empty: recorded only if the command line names a file
  std::vector<std::string> fields;  ///< fields to record; empty: the default ones
  std::optional<double> every_s;    ///< world time between two recorded ticks; not set: 0.1
  Where where;                      ///< for messages
  Where where_fields;               ///< position of `fields`, for messages
};

/// A whole world, from which engine::World is built. A program that fills it by hand calls add_ground()
/// first.
struct WorldSpec {
  std::string title;                             ///< for people
  std::shared_ptr<SourceFiles> files;            ///< files that the `Where` values refer to; may be null
  std::uint64_t seed = 1;                        ///< of all random numbers, and of the priorities of motions
  double tick_s = 0.1;                           ///< length of a tick; above 0
  std::optional<double> quit_time_s;             ///< world time at which a run ends by default
  std::optional<RecordSpec> record;              ///< not set: no recording
  RangingEngine ranging = RangingEngine::exact;  ///< how ranges are computed: docs/sensing.md
  double resolution_m = k_resolution_m;          ///< edge of the grid engine's cells
  Where resolution_where;                        ///< position of `resolution_m`, for messages
  /// Area in which body origins stay: a motion that would end outside is not made. Not set: +-100 km.
  std::optional<Box> bounds;
  std::vector<TypeSpec> types;  ///< TypeId is the position in this list
  Names names;                  ///< words of the bodies' names
  /// BodyId is the position in this list. Body 0 is the ground: add_ground().
  std::vector<BodySpec> bodies;
  std::vector<ReserveSpec> reserves;  ///< in ascending order of ids, without overlap
  bool mortal = false;  ///< programs may remove and disable bodies even if the world itself never does
  /// Further names of bodies, each once. In Stage, generated names remain as aliases.
  std::vector<NamedBody> aliases;
  /// Parts by their independent names (Stage: `name "/x"` in a child).
  std::unordered_map<std::string, PartName> part_aliases;
  /// Measures that a run takes, unless its options say otherwise.
  std::vector<MeasureSpec> measures;
  double measure_every_s = 1;    ///< seconds between two lines of measures
  WatchSpec watch;               ///< pace of a run, and reports of its time
  std::optional<Record> window;  ///< view that it asks for: worldio/window_fields.hpp
  ExperimentSpec experiment;     ///< interventions, faults and stop conditions

  /// Name of a body, as text.
  std::string name(BodyId body) const { return names.text(bodies[body.index()].name); }
  /// Whether a body is in the world at tick 0.
  bool starts(BodyId body) const {
    for (const ReserveSpec& reserve : reserves)
      if (body.value - reserve.first.value < reserve.count) return false;
    return true;
  }
};

/// Adds the ground, body 0 of every world: the body `_ground_model` of type `ground`, without solids.
void add_ground(WorldSpec& spec);

/// Reports inconsistencies between members of a world: a part whose parent comes later, a body whose type
/// does not exist, reserves that overlap, ... Each message begins with the path of the value:
/// `types[0].parts[2].parent: ...`. The limits of single members are in spec_description.cpp.
void check_rules(const WorldSpec& spec, const std::function<void(Where, const std::string&)>& report);

/// Appends a reserve of `count` bodies for each population of robots that has none. A population is here all
/// bodies named NAME0, NAME1, ... if they have one type, with a drive.
void add_spare(WorldSpec& spec, std::uint32_t count);

/// Value that fiducial finders read from a part of a body; 0: they do not find it.
inline std::int32_t fiducial_of(const WorldSpec& spec, BodyId body, std::uint32_t part) {
  const BodySpec& b = spec.bodies[body.index()];
  const std::int32_t of_type = spec.types[b.type.index()].parts[part].returns.fiducial;
  return part == 0 && of_type != 0 && b.fiducial != 0 ? b.fiducial : of_type;
}

/// True if the type has a drive.
inline bool is_mobile(const TypeSpec& type) { return type.drive.has_value(); }

/// True if part `below` is `part` or one of its descendants.
bool is_below(const TypeSpec& type, std::uint32_t below, std::uint32_t part);

}  // namespace troupe::engine
