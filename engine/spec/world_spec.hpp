#pragma once

#include "base/color.hpp"
#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/fields/fields.hpp"
#include "engine/spec/experiment_spec.hpp"
#include "engine/spec/measure_spec.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/ranging_engine.hpp"
#include "engine/spec/watch_spec.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace troupe::engine {

// The structs below are the expanded contents of a world file. They are plain data, which a loader makes from
// a file of any format, or a program fills by hand. engine::World is built from them. Lengths are in metres,
// angles in radians and times in seconds.
//
// A body is a robot or an object. All bodies of a type have the same rigid parts, joints, drive, devices
// (sensors and actuators) and controllers. A kind is the implementation of a sort of device, drive,
// controller or measure; the registry (struct Registry) is the list of all kinds. Time advances in ticks,
// steps of equal length; tick 0 is the initial state. A population is the set of bodies NAME0, NAME1, ... .
// Stage is another simulator, whose world files Troupe reads and writes.

/// Largest total number of corners of outlines. The readers of world files apply this limit to all types of a
/// world together, and World applies it to all static bodies together.
inline constexpr std::size_t k_most_vertices = 50000000;

/// How a part of a body interacts with other bodies and with their sensors.
struct Returns {
  bool obstacle = true;  ///< whether the part takes part in collisions
  /// Intensity that rangers (range sensors) read; below 0: rays of rangers pass through the part.
  float ranger = 1;
  /// Value that fiducial finders (sensors of markers) read; 0: they do not detect the part.
  std::int32_t fiducial = 0;
  std::int32_t fiducial_key = 0;  ///< only fiducial finders with the same key detect the part
  bool gripper = false;           ///< grippers detect the part and can grip its body
  bool pushable = false;          ///< robots can push the whole body: docs/pushing.md
  /// True: blob finders (cameras that find regions of one colour) report the colour of the part. False: the
  /// part only hides other parts from them. A finder whose parameter `use_blob_return` is false ignores this
  /// member and reports the part.
  bool blob = true;
  friend bool operator==(const Returns&, const Returns&) = default;
};

/// Value in place of the index of a joint: the part or device is not on a joint, but fixed to the body.
inline constexpr std::int32_t k_rigid = -1;

/// A joint: a frame of a body type that a device of the type, such as an actuator or a gripper, moves. Parts,
/// devices and further joints can be mounted on a joint. Their poses are given with every joint at rest.
struct JointSpec {
  std::string name;  ///< name; the joint's state is the state table `joint/<name>`
  /// Index of the joint that this joint is mounted on, lower than the index of this joint; k_rigid: none.
  std::int32_t parent = k_rigid;
  /// Frame of the joint at rest, in the body frame. Displacements of the joint are given in this frame.
  Pose pose_body_joint;
};

/// The image that a part's solids are made from. Only code that writes world files uses this struct; the
/// simulation uses the solids.
struct ImageSpec {
  /// Path of the image or, for a ROS map, of its YAML file: absolute or relative to the working folder.
  /// Readers of world files have already joined it with the folder of the world file.
  std::string file;
  /// True: the whole image is scaled to the part's size. False: the bounding box of its solid pixels is
  /// scaled to that size.
  bool keeps_margins = false;
  bool unknown_is_solid = false;  ///< for ROS maps: whether unknown cells are solid
  bool boundary = false;          ///< true: adds four walls just inside the edges of the image
  /// For a ROS map, pose of the frame of the map in the part's frame. For any other image, pose of the centre
  /// of the scaled image or, if `keeps_margins` is false, of the scaled bounding box, in the part's frame.
  Pose origin;
  friend bool operator==(const ImageSpec&, const ImageSpec&) = default;
};

/// The blocks that a part's solids are made from, as in Stage. All blocks together are scaled to fill the
/// part's size, centred in x and y, and placed at `origin`. Only code that writes world files uses this
/// struct; the simulation uses the solids.
struct FittedBlocks {
  std::vector<Solid> blocks;  ///< blocks before scaling, all in one frame and in any unit of length
  Pose origin;                ///< pose of the centre of the scaled blocks, in the part's frame
};

/// A part of a body type: a rigid piece of the body. Each model of a Stage model tree is a part.
struct PartSpec {
  std::string name;  ///< name within the body: "ranger:0"; empty for part 0, the root of the tree of parts
  /// A second name of the part, by which programs can find it; for parts from Stage files, the name that
  /// Stage generates. Empty: none.
  std::string alias;
  std::string kind;              ///< model kind, for code that writes world files: "position", "ranger", ...
  std::uint32_t parent = 0;      ///< index of the part that carries it; 0 for the root itself
  std::int32_t joint = k_rigid;  ///< index of the joint that it is mounted on; k_rigid: none
  Pose pose_body_part;           ///< pose of the part's frame in the body frame
  /// Declared size x, y, z, m, which fiducial finders report (in Stage, GetGeom() returns it). Collisions and
  /// rays depend on `solids` alone.
  Eigen::Vector3d size{0.4, 0.4, 1.0};
  std::vector<Solid> solids;  ///< in the body frame with joints at rest, m, after all scaling
  Returns returns;            ///< how it interacts with other bodies and with sensors
  /// Whether the part is a floor plan, such as an image of a building or the walls of an arena. Controllers
  /// that plan paths, and `troupe lint`, use its solids as the plan.
  bool floor_plan = false;
  std::optional<ImageSpec> image;      ///< the image that `solids` are made from; not set: no image
  std::optional<FittedBlocks> fitted;  ///< the blocks that `solids` are made from; not set: none
  std::optional<Color> color;          ///< colour of the part; not set: the body's colour
  Where where;                         ///< position in the file, for messages
};

/// A device (a sensor or an actuator) that each body of a type has.
struct DeviceSpec {
  /// Name of the device in its type. A program that fills this struct must set the name, because no code
  /// derives it from `part`. If an earlier device of the type has the same name, the world appends `#2` (or
  /// `#3`, ...) to the name and warns.
  std::string name;
  std::string kind;              ///< name of a kind of device (DeviceKind::name), such as "ranger"
  std::uint32_t part = 0;        ///< index of the part that carries it
  std::int32_t joint = k_rigid;  ///< index of the joint that it is mounted on; k_rigid: none
  /// Index of the first of the joints that the device moves (DeviceKind::joints); k_rigid: it moves none.
  std::int32_t moves = k_rigid;
  Record params;  ///< one value for each parameter of the kind (DeviceKind::params)
  /// Pose of the device's frame in the body frame, with joints at rest. Parameters that are poses or points
  /// are given in the device's frame.
  Pose pose_body_device;
  double period_s = 0;  ///< time from one run to the next, s; 0: it runs in every tick
  bool active = true;   ///< true: the device runs even if no controller and no program reads it
  Where where;          ///< position in the file, for messages
};

/// The drive of the bodies of a type.
struct DriveSpec {
  std::string kind;  ///< name of a kind of drive (DriveKind::name), such as "diff"
  /// One value for each parameter of the kind (DriveKind::params); FieldTable::defaults() makes such a
  /// record.
  Record params;
  double period_s = 0;  ///< time from one run to the next, s; 0: it runs in every tick
  Where where;          ///< position in the file, for messages
};

/// A controller of the bodies of a type.
struct ControllerSpec {
  std::string kind;  ///< name of a kind of controller (ControllerKind::name), which may come from a plug-in
  /// Index of the part that the controller is on. The controller may use the devices of this part and of the
  /// parts mounted on this part, directly or through further parts. It cannot use devices that are drives of
  /// a part (DeviceKind::drives).
  std::uint32_t part = 0;
  /// One value for each parameter of the kind (ControllerKind::params); FieldTable::defaults() makes such a
  /// record.
  Record params;
  /// Time from one decision to the next, s; 0: every tick. Used only if the controller uses no device and
  /// the type has no drive. Otherwise the controller has the period of the first device that it uses or, if
  /// it uses none, of the drive.
  double period_s = 0;
  Where where;  ///< position in the file, for messages
};

/// A body type: everything that identical bodies share.
struct TypeSpec {
  std::string name;                ///< name, unique in the world
  std::vector<PartSpec> parts;     ///< parts in depth-first order; part 0 is the root
  std::vector<JointSpec> joints;   ///< joints; each comes after its parent joint
  std::optional<DriveSpec> drive;  ///< drive; not set: the bodies have none
  /// Devices. A device that moves a joint comes before the devices that are mounted on the joint.
  std::vector<DeviceSpec> devices;
  /// The controllers, in the order in which they compute their commands in a tick. If several controllers
  /// command one drive, the last command counts.
  std::vector<ControllerSpec> controllers;
};

/// One body of the world.
struct BodySpec {
  Name name;             ///< name of the body, in the table WorldSpec::names
  TypeId type;           ///< type of the body: index into WorldSpec::types
  Pose pose_world_body;  ///< pose at tick 0, world frame
  Color color;           ///< colour of the parts that set none
  /// Value that fiducial finders (sensors of markers) read from the root part of this body (part 0). It
  /// replaces Returns::fiducial of the type's root part, so that robots with different fiducial values can
  /// share a type. It has no effect if it is 0, or if Returns::fiducial of the root part is 0.
  std::int32_t fiducial = 0;
  Where where;  ///< position in the file, for messages
};

/// A reserve: bodies of a population that are unborn (not in the world) at tick 0 and can be born later, in
/// ascending order of ids (docs/lives.md). They have the ids [first, first + count) and are all of one type.
/// Each body gets its pose when it is born.
struct ReserveSpec {
  std::string population;   ///< name of the population: "r" for the bodies "r0", "r1", ...
  BodyId first;             ///< lowest id of the reserve
  std::uint32_t count = 0;  ///< number of bodies in the reserve
};

/// A part that has a name of its own in the world, independent of the name of its body
/// (WorldSpec::part_aliases).
struct PartName {
  BodyId body;       ///< the body that has the part
  std::string part;  ///< name of the part (PartSpec::name)
};

/// The recording that the world file asks for: a file with selected fields of the state over time
/// (docs/recordings.md).
struct RecordSpec {
  /// Path of the recording, relative to the working folder. Empty: a run is recorded only if the command line
  /// names a file.
  std::string file;
  std::vector<std::string> fields;  ///< fields to record; empty: the default fields (docs/recordings.md)
  std::optional<double> every_s;    ///< world time from one recorded tick to the next, s; not set: 0.1 s
  Where where;                      ///< position in the file, for messages
  Where where_fields;               ///< position of `fields`, for messages
};

/// A whole world, from which engine::World is built. A program that fills this struct by hand calls
/// add_ground() first, because body 0 must be the ground.
struct WorldSpec {
  std::string title;                   ///< title of the world, for display
  std::shared_ptr<SourceFiles> files;  ///< files that the `Where` values refer to; may be null
  std::uint64_t seed = 1;              ///< seed of all random numbers, and of priorities in motion conflicts
  double tick_s = 0.1;                 ///< length of a tick, s; above 0
  std::optional<double> quit_time_s;   ///< world time at which a run ends by default, s; not set: none
  std::optional<RecordSpec> record;    ///< the recording that the world asks for; not set: none
  RangingEngine ranging = RangingEngine::exact;  ///< how ranges are computed: docs/sensing.md
  double resolution_m = k_resolution_m;          ///< edge of the cells of RangingEngine::grid, m
  Where resolution_where;                        ///< position of `resolution_m`, for messages
  /// Box in which the origins of bodies must stay, m, world frame. A body does not make a motion that would
  /// end outside the box. If this member is not set, the box reaches from -100 km to 100 km in x and y.
  std::optional<Box> bounds;
  std::vector<TypeSpec> types;  ///< body types; TypeId is the position in this list
  /// Texts of all `Name` values in `bodies` and `aliases`. A Name consists of a word of this table and,
  /// optionally, a number: "r17" is the word "r" and the number 17.
  Names names;
  /// The bodies; BodyId is the position in this list. Body 0 is the ground, which add_ground() adds.
  std::vector<BodySpec> bodies;
  std::vector<ReserveSpec> reserves;  ///< reserves in ascending order of ids; they do not overlap
  /// True: a program may remove and disable bodies during a run. False: it may remove bodies only if bodies
  /// can also be born or die for another reason, such as a reserve (World::has_lives()). It may disable
  /// bodies only if the world file also has interventions that disable or enable bodies, or faults
  /// (World::has_conditions()).
  bool mortal = false;
  /// Further names of bodies; no name occurs twice. For example, a model of a Stage file with the key `name`
  /// can also be found under the name that Stage generates for it.
  std::vector<NamedBody> aliases;
  /// Parts that have a name of their own in the world, independent of the name of their body. The key is
  /// this name: `x` for a child model with `name "/x"` in a Stage file.
  std::unordered_map<std::string, PartName> part_aliases;
  /// Measures (numbers computed from the state) that a run computes, unless its options choose others.
  std::vector<MeasureSpec> measures;
  double measure_every_s = 1;  ///< world time from one measurement to the next, s; 0: every tick
  WatchSpec watch;             ///< speed of a run, and how often the world time is printed
  /// Settings of the view that the command-line option `--camera window` draws: one value per field of the
  /// table in worldio/window_fields.hpp. Not set: none.
  std::optional<Record> window;
  ExperimentSpec experiment;  ///< interventions, faults and stop conditions

  /// Type of a body.
  const TypeSpec& type(BodyId body) const { return types[bodies[body.index()].type.index()]; }
  /// Name of a body, as text.
  std::string name(BodyId body) const { return names.text(bodies[body.index()].name); }
  /// Whether a body is in the world at tick 0. False if it belongs to a reserve.
  bool starts(BodyId body) const {
    for (const ReserveSpec& reserve : reserves)
      if (body.value - reserve.first.value < reserve.count) return false;
    return true;
  }
};

/// Appends the ground, which must be body 0 of every world: the type `ground` and its body `_ground_model`,
/// without solids. Call this once, before any other body is added.
void add_ground(WorldSpec& spec);

/// Checks the members of a world against one another. Calls report(place in the file, message) for each
/// inconsistency that it finds, such as a part whose parent comes later, a body whose type does not exist, or
/// reserves that overlap. Further inconsistencies may appear when the reported ones are corrected. Each
/// message begins with the path of the value: `types[0].parts[2].parent: ...`. This function does not check
/// the limits of single members, which are in the tables of engine/spec/spec_description.hpp.
void check_rules(const WorldSpec& spec, const std::function<void(Where, const std::string&)>& report);

/// Appends a reserve of `count` unborn bodies (at least 1) for each population of robots that has no reserve.
/// Here a population is the set of all robots (bodies with a drive) named NAME followed by a number. A
/// population whose robots are of several types is skipped. The new bodies get the numbers after the highest
/// number of the population, except numbers that would give them the name of another body. Their poses are 0.
/// All their other members are copies of those of the population's first body.
///
/// names   names of populations that may end in a digit: with `team1` in this list, `team12` is number 2 of
///         the population `team1`; without it, number 12 of `team`
void add_spare(WorldSpec& spec, std::uint32_t count, std::span<const std::string> names = {});

/// Returns the value that fiducial finders (sensors of markers) read from the part with index `part` of a
/// body; 0: they do not detect the part. For the root part, BodySpec::fiducial is taken into account.
inline std::int32_t fiducial_of(const WorldSpec& spec, BodyId body, std::uint32_t part) {
  const BodySpec& b = spec.bodies[body.index()];
  const std::int32_t of_type = spec.types[b.type.index()].parts[part].returns.fiducial;
  return part == 0 && of_type != 0 && b.fiducial != 0 ? b.fiducial : of_type;
}

/// Whether the type has a drive.
inline bool is_mobile(const TypeSpec& type) { return type.drive.has_value(); }

/// Whether grippers can grip bodies of the type: whether a part of the type has solids and Returns::gripper.
bool can_be_gripped(const TypeSpec& type);

/// Whether bodies of the type never move, because they have no drive and cannot be gripped or pushed.
bool is_static(const TypeSpec& type);

/// Radius of the circle about the body's origin that encloses all solids of the type, with joints at rest, m;
/// 0 if there are none.
double solids_radius(const TypeSpec& type);

/// Whether the part with index `below` is the part with index `part`, or is mounted on that part, directly or
/// through further parts.
bool is_below(const TypeSpec& type, std::uint32_t below, std::uint32_t part);

}  // namespace troupe::engine
