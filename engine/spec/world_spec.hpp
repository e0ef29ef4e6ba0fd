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

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace troupe::engine {

// The structs below describe a world, as a world file does. They are plain data, which a loader makes from a
// file of any format, or a program fills by hand. engine::World is built from them. Lengths are in metres,
// angles in radians and times in seconds.

/// Largest total number of corners of the shapes of bodies. The readers of world files apply this limit to
/// all types of a world together, and World to all static bodies together.
inline constexpr std::size_t k_most_vertices = 50000000;

/// How a part of a body interacts with other bodies and with their sensors.
struct Returns {
  bool obstacle = true;  ///< whether the part takes part in collisions
  /// Intensity that rangers (range sensors) read from the part; below 0: rays of rangers pass through the
  /// part.
  float ranger = 1;
  /// Value that fiducial finders (sensors of markers) read from the part; 0: they do not detect the part.
  std::int32_t fiducial = 0;
  std::int32_t fiducial_key = 0;  ///< only fiducial finders with the same key detect the part
  bool gripper = false;           ///< whether grippers detect the part and can grip its body
  bool pushable = false;          ///< whether robots can push the whole body: docs/pushing.md
  /// Whether blob finders (cameras that find regions of one colour) report the part. If false, the part still
  /// hides parts behind it from blob finders. A blob finder whose parameter `use_blob_return` is false
  /// ignores this member and reports the part.
  bool blob = true;
  friend bool operator==(const Returns&, const Returns&) = default;
};

/// The value "no joint" of the index of a joint. A part, device or joint with this value is not mounted on a
/// joint, but fixed to the body.
inline constexpr std::int32_t k_rigid = -1;

/// A joint: a frame of a body that a device of the body, such as an actuator or a gripper, moves. Parts,
/// devices and further joints can be mounted on a joint, and then move with it. A joint is *at rest* while
/// its displacement from `pose_body_joint` is zero. The poses of all parts, devices and joints of a type are
/// those with every joint at rest.
struct JointSpec {
  std::string name;  ///< name; the state table `joint/<name>` has the displacements of the joint
  /// Index in TypeSpec::joints of the joint that this joint is mounted on. It is lower than the index of this
  /// joint. k_rigid: this joint is mounted on no other joint.
  std::int32_t parent = k_rigid;
  /// Pose of the joint at rest, in the body frame. Displacements of the joint are poses relative to this
  /// pose.
  Pose pose_body_joint;
};

/// The image from which the solids of a part were made. Only code that writes world files uses this struct;
/// the simulation uses the solids.
struct ImageSpec {
  /// Path of the image or, for a ROS map, of its YAML file: absolute, or relative to the working folder of
  /// the program. (In a world file, the path is relative to the folder of that file. Readers of world files
  /// convert it.)
  std::string file;
  /// Which region of the image is scaled to the size of the part (PartSpec::size). True: the whole image.
  /// False: the bounding box of the dark pixels, which become walls. Not used for ROS maps, because their
  /// YAML file gives the scale.
  bool keeps_margins = false;
  bool unknown_is_solid = false;  ///< for ROS maps: whether unknown cells are solid
  bool boundary = false;          ///< true: adds four walls just inside the edges of the image
  /// A pose in the frame of the part. For a ROS map, it is the pose of the frame of the map. For any other
  /// image, it is the pose of the centre of the region that `keeps_margins` selects.
  Pose origin;
  friend bool operator==(const ImageSpec&, const ImageSpec&) = default;
};

/// The blocks of a Stage file from which the solids of a part were made. To make the solids, all blocks
/// together are scaled to the size of the part (PartSpec::size), centred in x and y, and placed at `origin`.
/// Only code that writes world files uses this struct; the simulation uses the solids.
struct FittedBlocks {
  std::vector<Solid> blocks;  ///< blocks before scaling, all in one frame and in any unit of length
  Pose origin;                ///< pose of the frame of the scaled and centred blocks, in the part's frame
};

/// A part of a body type: a rigid piece of the body. Each model in the tree of models by which a Stage file
/// describes a body is a part.
struct PartSpec {
  std::string name;  ///< name within the body: "ranger:0"; empty for part 0, the root of the tree of parts
  /// A second name of the part, under which programs can also find it; empty: none. For a part that has a
  /// name in a Stage file, it is the name that Stage would generate for a part without a name.
  std::string alias;
  std::string kind;              ///< model kind, for code that writes world files: "position", "ranger", ...
  std::uint32_t parent = 0;      ///< index of the part that this part is mounted on; 0 for part 0
  std::int32_t joint = k_rigid;  ///< index of the joint that the part is mounted on; k_rigid: none
  Pose pose_body_part;           ///< pose of the part's frame in the body frame, with joints at rest
  /// Declared size x, y, z, m, which fiducial finders (sensors of markers) report. In Stage, GetGeom()
  /// returns it. Collisions and rays depend on `solids` alone.
  Eigen::Vector3d size{0.4, 0.4, 1.0};
  std::vector<Solid> solids;  ///< in the body frame with joints at rest, m, after all scaling
  Returns returns;            ///< how the part interacts with other bodies and with sensors
  /// Whether the part is a floor plan, such as an image of a building or the walls of an arena. Controllers
  /// that plan paths, and the command `troupe lint`, use the solids of floor plans as their map.
  bool floor_plan = false;
  std::optional<ImageSpec> image;      ///< the image that `solids` are made from; not set: no image
  std::optional<FittedBlocks> fitted;  ///< the blocks that `solids` are made from; not set: none
  std::optional<Color> color;          ///< colour of the part; not set: the body's colour
  Where where;                         ///< position in the file, for messages
};

/// A device (a sensor or an actuator) that each body of a type has.
struct DeviceSpec {
  /// Name of the device, which must be set. If an earlier device of the type has the same name, World appends
  /// `#2` (or `#3`, ...) to the name of this device, and warns.
  std::string name;
  std::string kind;              ///< name of a kind of device (DeviceKind::name), such as "ranger"
  std::uint32_t part = 0;        ///< index of the part that the device is on
  std::int32_t joint = k_rigid;  ///< index of the joint that the device is mounted on; k_rigid: none
  /// Index in TypeSpec::joints of the first joint that the device moves; k_rigid: it moves none. If the
  /// device moves several joints, the others follow directly. DeviceKind::joints lists the joints that
  /// devices of a kind move.
  std::int32_t moves = k_rigid;
  Record params;  ///< one value for each parameter of the kind (DeviceKind::params)
  /// Pose of the device's frame in the body frame, with joints at rest. Parameters of the device that are
  /// poses or points are given in the device's frame.
  Pose pose_body_device;
  double period_s = 0;  ///< time from one run to the next, s; 0: it runs in every tick
  bool active = true;   ///< true: the device runs even if no controller and no program reads it
  Where where;          ///< position in the file, for messages
};

/// The drive of the bodies of a type.
struct DriveSpec {
  std::string kind;  ///< name of a kind of drive (DriveKind::name), such as "diff"
  /// One value for each parameter of the kind, in the order of the table DriveKind::params, whose function
  /// FieldTable::defaults() returns the default values.
  Record params;
  double period_s = 0;  ///< time from one run to the next, s; 0: it runs in every tick
  Where where;          ///< position in the file, for messages
};

/// A controller of the bodies of a type.
struct ControllerSpec {
  std::string kind;  ///< name of a kind of controller (ControllerKind::name), which may come from a plug-in
  /// Index in TypeSpec::parts of the part that the controller is on. The controller may use the devices of
  /// this part, and of all parts that are mounted on this part, directly or through further parts. Drive
  /// devices (DeviceKind::drives), which move a part as a drive moves a body, do not count here: the
  /// controller commands such a device in place of the drive of the body.
  std::uint32_t part = 0;
  /// One value for each parameter of the kind, in the order of the table ControllerKind::params, whose
  /// function FieldTable::defaults() returns the default values.
  Record params;
  /// Time from one decision to the next, s; 0: every tick. This period applies only if the controller uses no
  /// devices and the type has no drive. A controller that uses devices has the period of the first of these
  /// devices. A controller that uses no devices, in a type with a drive, has the period of the drive.
  double period_s = 0;
  Where where;  ///< position in the file, for messages
};

/// A body type: everything that identical bodies share.
struct TypeSpec {
  std::string name;                ///< name; several types may have the same name
  std::vector<PartSpec> parts;     ///< parts in depth-first order; part 0 is the root
  std::vector<JointSpec> joints;   ///< joints; each comes after its parent joint
  std::optional<DriveSpec> drive;  ///< drive; not set: the bodies have none
  /// The devices. A device that moves a joint comes before the devices that are mounted on the joint.
  std::vector<DeviceSpec> devices;
  /// The controllers, in the order in which they compute their commands in a tick. If several controllers
  /// command one drive, the last command counts.
  std::vector<ControllerSpec> controllers;
};

/// Whether the types include the type of a setting, and this type has the drive, device or controller that
/// the setting changes.
bool has_params(std::span<const TypeSpec> types, const SettingSpec& setting);
/// Returns the parameters of a type that a setting changes: those of the drive, of a device or of a
/// controller. They must exist (has_params()).
Record& params_of(TypeSpec& type, const SettingSpec& setting);

/// One body of the world.
struct BodySpec {
  Name name;    ///< name of the body, in the table WorldSpec::names
  TypeId type;  ///< type of the body: index into WorldSpec::types
  /// Pose at tick 0, world frame. Of a body of a reserve, only the height z has an effect: see ReserveSpec.
  Pose pose_world_body;
  Color color;  ///< colour of the parts that set none
  /// Value that fiducial finders (sensors of markers) read from part 0 of this body, in place of the value of
  /// the type, which is Returns::fiducial of part 0. Robots with different values can thus share a type. This
  /// member has no effect if it is 0, or if the value of the type is 0.
  std::int32_t fiducial = 0;
  Where where;  ///< position in the file, for messages
};

/// A reserve: bodies of one population and one type that are *unborn* at tick 0, which means that they are
/// not in the world. They can be born later, in ascending order of ids (docs/lives.md). A body gets its pose
/// at its birth. An intervention `add` that draws random poses takes their height, z, from
/// BodySpec::pose_world_body. The ids of the reserve are consecutive: first, first + 1, ..., first + count
/// - 1. A population has at most one reserve.
struct ReserveSpec {
  std::string population;   ///< name of the population: "r" for the bodies "r0", "r1", ...
  BodyId first;             ///< lowest id of the reserve
  std::uint32_t count = 0;  ///< number of bodies in the reserve
};

/// A population that has neither bodies nor a reserve, for example because of the option --robots. Its name
/// is known to interventions, faults, measures and swarms, which then act on no body.
struct EmptyPopulation {
  std::string name;  ///< name of the population
  TypeId type;       ///< type that its bodies would have
};

/// The part to which a name in WorldSpec::part_aliases refers.
struct PartName {
  BodyId body;       ///< the body that has the part
  std::string part;  ///< name of the part (PartSpec::name)
};

/// The recording that a world file asks for: a file with selected fields of the state over time
/// (docs/recordings.md).
struct RecordSpec {
  /// Path of the recording, relative to the working folder. Empty: a run is recorded only if the command line
  /// names a file.
  std::string file;
  std::vector<std::string> fields;  ///< fields to record; empty: the default fields (docs/recordings.md)
  std::optional<double> every_s;    ///< simulated time from one recorded tick to the next, s; not set: 0.1 s
  Where where;                      ///< position in the file, for messages
  Where where_fields;               ///< position of `fields`, for messages
};

/// A whole world, from which engine::World is built. A program that fills this struct by hand calls
/// add_ground() first, because body 0 must be the ground.
struct WorldSpec {
  std::string title;                   ///< title of the world, for display
  std::shared_ptr<SourceFiles> files;  ///< input files, to which the `Where` values refer; may be null
  std::uint64_t seed = 1;              ///< seed of all random numbers, and of priorities in motion conflicts
  double tick_s = 0.1;                 ///< length of a tick, s; above 0
  std::optional<double> quit_time_s;   ///< simulated time at which a run ends by default, s; not set: no end
  std::optional<RecordSpec> record;    ///< the recording that the world asks for; not set: none
  RangingEngine ranging = RangingEngine::exact;  ///< how ranges are computed: docs/sensing.md
  double resolution_m = k_resolution_m;          ///< edge of the cells of RangingEngine::grid, m
  Where resolution_where;                        ///< position of `resolution_m`, for messages
  /// Box in which the origins of bodies must stay, m, world frame. A body does not make a motion that would
  /// end outside the box. Not set: the box reaches from -100 km to 100 km in x and y.
  std::optional<Box> bounds;
  std::vector<TypeSpec> types;  ///< body types; TypeId is the position in this list
  /// The words of all names in `bodies` and `aliases`. A Name is one of these words, or a word followed by a
  /// number: "r17" is the word "r" and the number 17.
  Names names;
  /// The bodies; BodyId is the position in this list. Body 0 is the ground, which add_ground() adds.
  std::vector<BodySpec> bodies;
  std::vector<ReserveSpec> reserves;  ///< reserves in ascending order of ids; they do not overlap
  std::vector<EmptyPopulation> empty_populations;  ///< populations without bodies, in the order of the file
  /// Whether programs may remove and disable bodies during a run, also if nothing in the world does
  /// (CommittedView::has_lives(), has_conditions()).
  bool mortal = false;
  /// True: the state has the component `contact` (Contact), which says what blocked each body in the last
  /// tick. It also has it if a controller reads it (ControllerKind::reads_contacts).
  bool contacts = false;
  /// Further names of bodies; each occurs only once in this list. For example, a model that has a `name` in a
  /// Stage file can also be found under the name that Stage would generate for a model without a name.
  std::vector<NamedBody> aliases;
  /// Parts that programs can find without the name of the body; the key is the name to search for. Programs
  /// find other parts by the names of body and part: "r0.ranger:1" is the part "ranger:1" of the body "r0".
  std::unordered_map<std::string, PartName> part_aliases;
  /// Measures that a run computes, unless the user chooses others for the run.
  std::vector<MeasureSpec> measures;
  double measure_every_s = 1;  ///< simulated time from one measurement to the next, s; 0: every tick
  WatchSpec watch;             ///< speed of a run, and how often the simulated time is printed
  /// Settings of the view that the command-line option `--camera window` draws: one value per field of the
  /// table in worldio/window_fields.hpp. Not set: the world file gives no such settings.
  std::optional<Record> window;
  ExperimentSpec experiment;  ///< interventions, faults and stop conditions

  /// Type of a body.
  const TypeSpec& type(BodyId body) const { return types[bodies[body.index()].type.index()]; }
  /// Name of a body, as text.
  std::string name(BodyId body) const { return names.text(bodies[body.index()].name); }
  /// The reserve to which a body belongs; null if it belongs to none.
  const ReserveSpec* reserve_of(BodyId body) const {
    const auto later = std::ranges::upper_bound(
        reserves, body.value, {}, [](const ReserveSpec& reserve) { return reserve.first.value; });
    if (later == reserves.begin()) return nullptr;
    const ReserveSpec& reserve = *std::prev(later);
    return body.value - reserve.first.value < reserve.count ? &reserve : nullptr;
  }
  /// Whether a body is in the world at tick 0. False if the body belongs to a reserve.
  bool starts(BodyId body) const { return reserve_of(body) == nullptr; }
};

/// Appends the ground, which must be body 0 of every world: the type `ground` and its body `_ground_model`,
/// without solids. Call this once, before any other body is added.
void add_ground(WorldSpec& spec);

/// Checks that the members of a world are consistent with one another. Calls report(place in the file,
/// message) for each inconsistency that it finds, such as a part whose parent comes later, a body whose type
/// does not exist, or reserves that overlap. Each message begins with the path of the value:
/// `types[0].parts[2].parent: ...`. Some inconsistencies are found only after others have been corrected.
/// This function does not check the limits of single members, which are in the tables of
/// engine/spec/spec_description.hpp.
void check_rules(const WorldSpec& spec, const std::function<void(Where, const std::string&)>& report);

/// Adds a reserve of `count` unborn bodies (at least 1) to each population of robots that has no reserve. A
/// robot is a body with a drive. All robots whose names are NAME and a number belong to the population NAME.
/// If these robots are of several types, the population gets no reserve.
///
/// The new bodies get the numbers after the highest number of the population. Numbers that would repeat the
/// name of another body are left out. The poses of the new bodies are 0, except for the height. The height
/// and the other members are copies of those of the population's first body.
///
/// names   names of populations that end in a digit. If `team1` is in this list, the robot `team12` is number
///         2 of the population `team1`. Otherwise it is number 12 of the population `team`
void add_spare(WorldSpec& spec, std::uint32_t count, std::span<const std::string> names = {});

/// Returns the value that fiducial finders (sensors of markers) read from a part of a body; 0: they do not
/// detect the part. `part` is an index into TypeSpec::parts. For part 0, the value is that of
/// BodySpec::fiducial if this member has an effect. In all other cases it is Returns::fiducial of the part.
inline std::int32_t fiducial_of(const WorldSpec& spec, BodyId body, std::uint32_t part) {
  const BodySpec& b = spec.bodies[body.index()];
  const std::int32_t of_type = spec.types[b.type.index()].parts[part].returns.fiducial;
  return part == 0 && of_type != 0 && b.fiducial != 0 ? b.fiducial : of_type;
}

/// Whether the type has a drive.
inline bool is_mobile(const TypeSpec& type) { return type.drive.has_value(); }

/// Whether grippers can grip bodies of the type: whether a part of the type has solids and Returns::gripper.
bool can_be_gripped(const TypeSpec& type);

/// Whether bodies of the type never move: they have no drive and cannot be gripped or pushed.
bool is_static(const TypeSpec& type);

/// Radius of the circle about the body's origin that encloses all solids of the type, with joints at rest, m;
/// 0 if the type has no solids.
double solids_radius(const TypeSpec& type);

/// Whether the part with index `below` is the part with index `part`, or is mounted on that part, directly or
/// through further parts.
bool is_below(const TypeSpec& type, std::uint32_t below, std::uint32_t part);

}  // namespace troupe::engine
