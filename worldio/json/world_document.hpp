#pragma once

#include "base/color.hpp"
#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/limits.hpp"
#include "base/pose.hpp"
#include "engine/fields/fields.hpp"
#include "engine/spec/experiment_spec.hpp"
#include "engine/spec/placement.hpp"
#include "engine/spec/ranging_engine.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_node.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// The content of a JSON world as plain structs. Numbers are in SI units. expand() converts a WorldDocument
/// to an engine::WorldSpec, the description that the engine uses; write_json_world() does the reverse. The
/// keys of the JSON objects, with their units, limits and meanings, are in world_document.cpp and in
/// docs/world-format.md. A comment "required" means: if the key is missing, the reader reports an error, and
/// the member stays empty.
///
/// Words of world files:
/// - A *type* describes bodies of the same construction.
/// - A *part* is a rigid piece of a body. The parts of a body form a tree, whose root is the body itself.
/// - A *device* is a sensor, or another instrument such as a gripper or a light.
/// - A *joint* is a frame of a body that a device, such as an actuator, moves. Parts and devices that are
///   mounted on a joint move with it.
/// - A *kind* is a sort of drive, device, controller, measure or fault, with parameters of its own. The
///   engine::Registry lists all kinds.
/// - A *population* is a group of bodies of one type that are placed by a rule, for example on a grid.
/// - The *reserve* of a population consists of bodies that are absent at the start and can enter the world
///   (be born) later.
/// - A *fiducial finder* is a sensor that detects marked bodies and reads their numbers.
/// - A *measure* is a number that is computed from the state of a run.
/// - A *tick* is a time step.
/// - A *place* (Where) is the file and the line of a value, for error messages.
namespace troupe::worldio {

/// Collects the JSON keys of T, one of the structs below: T::describe() adds one key per member. Defined in
/// worldio/json/document_table.hpp.
template <class T>
class DocumentKeys;

inline constexpr std::int64_t k_format_version = 1;      ///< the only version of the format
inline constexpr double k_max_size_m = k_world_reach_m;  ///< maximum of sizes and absolute coordinates, m
/// Greatest number of points of a block (BlockDocument), of a line of walls, or of the polygon of a placement
/// rule (PlaceDocument). The limit bounds the time of check_outline(), which grows with the square of the
/// number of points.
inline constexpr std::size_t k_most_block_points = 1000;

/// Base of the structs that are read from JSON objects. It stores the place of the object and the places of
/// its values, for error messages. The parameters of a kind are also keys of the object, but their places are
/// not stored here.
struct Placed {
  /// A key that the object has, even if the value of the key is wrong.
  struct Key {
    /// Name of the key. If a file can choose the unit, the name has no unit: "period" stands for `period_s`
    /// and for `period_ms`. Otherwise it is the whole key, such as "points_m".
    std::string_view name;
    Where where;  ///< place of the value
  };
  Where where;  ///< where the object begins in its file
  /// The keys that the object has, in the order in which the function describe() of its struct adds them.
  std::vector<Key> keys;

  bool says(std::string_view key) const;  ///< whether `keys` has a Key of this name
  /// Returns the place of the value of a key. If `keys` has no Key of this name, returns the place of the
  /// object.
  Where where_of(std::string_view key) const;
};

/// The value of a key `joint`: the name of a joint of the body, or null for no joint.
struct JointName {
  std::optional<std::string> name;  ///< name of the joint; empty: no joint
};

// ---- bodies

/// An upright prism: a solid of a type, a part or a device.
struct BlockDocument : Placed {
  /// The frame of the points.
  enum class Frame : std::uint8_t {
    part,  ///< the frame of the part or device that has the block
    body,  ///< the frame of the body
  };
  std::optional<Ring> points;  ///< the outline, m; required unless `contours` is given
  /// Instead of `points`: outlines, m. A point inside an odd number of them is solid.
  std::optional<std::vector<Ring>> contours;
  std::optional<std::array<double, 2>> z;                ///< heights of bottom and top, m; required
  Frame frame = Frame::part;                             ///< frame of the points
  static void describe(DocumentKeys<BlockDocument>& d);  ///< adds the keys of this struct to `d`
};

/// The value of the key `ring`, which a list entry with a pose may have. The reader replaces the entry by
/// copies, at equal angles on a circle around the position of the entry, before it reads the list
/// (expand_ring() in worldio/json/json_ring.hpp).
struct RingDocument : Placed {
  std::int64_t count = 0;  ///< number of copies, at least 1; required
  double radius = 0;       ///< radius of the circle, m
  double start = 0;        ///< direction of the first copy, rad, counter-clockwise from the object's heading
  static void describe(DocumentKeys<RingDocument>& d);  ///< adds the keys of this struct to `d`
};

/// An upright cylinder that stands on z = 0, as a prism whose base is a regular polygon.
struct DiscDocument : Placed {
  std::optional<double> radius;  ///< distance of the corners from the axis, m; required
  std::optional<double> height;  ///< height of the top above z = 0, m; required
  std::int64_t corners = 16;     ///< number of corners; the first is on the x axis
  static void describe(DocumentKeys<DiscDocument>& d);  ///< adds the keys of this struct to `d`
};

/// An image, or a ROS map (a floor plan in the format of ROS's map_server), from which the shape of a part or
/// floor plan is made.
struct ImageDocument {
  /// The region of an image that is scaled to `size`.
  enum class Margins : std::uint8_t {
    trim,  ///< the bounding box of the solid pixels
    keep,  ///< the whole image
  };
  /// How unknown cells of a map are treated.
  enum class Unknown : std::uint8_t {
    free,   ///< unknown cells are floor
    solid,  ///< unknown cells are walls
  };
  std::string bitmap;  ///< path, relative to the folder of the world file; empty: no image
  /// Size [x, y, z] to which the image is scaled, m. Empty for a map, which has a size of its own.
  std::optional<Eigen::Vector3d> size;
  std::optional<double> height;     ///< height of the walls of a map or of walls along a line, m; empty: 1 m
  Unknown unknown = Unknown::free;  ///< how unknown cells of a map are treated
  Margins margins = Margins::trim;  ///< the region of the image that is scaled to `size`
  bool boundary = false;  ///< true: adds four walls just inside the edges of the scaled image or map
};

/// A device of a type or part.
struct DeviceDocument : Placed {
  /// Name of the device. Empty: the name consists of the kind and a number, as in "ranger:0". An
  /// OwnDeviceDocument without a name has the name of its part.
  std::string name;
  std::string kind;  ///< name of a kind in Registry::devices
  /// True: the writer omits the key `kind`. Used only in an OwnDeviceDocument, if the model type of the part
  /// (PartDocument::kind) determines the kind of the device: a part of the model type "ranger" is a ranger.
  bool is_kind_implied = false;
  /// Pose in the frame of the body or, if `on` is not empty, in the frame of the device `on`. Empty: at the
  /// origin of this frame, with heading 0. An OwnDeviceDocument without a pose has the pose of its part.
  std::optional<Pose> pose;
  std::optional<JointName> joint;  ///< joint that moves the device; empty: the joint that moves its part
  bool active = true;     ///< false: the device runs only while a controller or a user program reads it
  double period = 0;      ///< time between two updates, s; 0: every tick
  engine::Record params;  ///< one value per parameter of the kind (DeviceKind::params)
  std::string on;         ///< name of the device on which this one is mounted; empty: none
  // The members below describe the body of an entry of `devices` that has a joint. Other devices have no
  // body. The size and blocks of grippers follow from their parameters.
  std::optional<Color> color;           ///< colour of the device; empty: that of the robot's body
  engine::Returns returns;              ///< how other bodies collide with the device and sense it
  std::optional<Eigen::Vector3d> size;  ///< [x, y, height] of a box, m, in the device frame; empty: no box
  std::vector<BlockDocument> blocks;    ///< solids in addition to the box
  static void describe(DocumentKeys<DeviceDocument>& d);  ///< adds the keys of this struct to `d`
};
/// An entry of the list `sensors` of a type or part.
struct SensorDocument : DeviceDocument {
  static void describe(DocumentKeys<SensorDocument>& d);  ///< adds the keys of this struct to `d`
};
/// The value of the key `device` of a part that is itself a device.
struct OwnDeviceDocument : DeviceDocument {
  static void describe(DocumentKeys<OwnDeviceDocument>& d);  ///< adds the keys of this struct to `d`
};

/// The drive of a type.
struct DriveDocument : Placed {
  std::string kind;       ///< name of a kind in Registry::drives
  double period = 0;      ///< time between two commands that the drive accepts, s; 0: every tick
  engine::Record params;  ///< one value per parameter of the kind (DriveKind::params)
  static void describe(DocumentKeys<DriveDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A controller of a type or part.
struct ControllerDocument : Placed {
  std::string kind;  ///< name of a kind in Registry::controllers
  /// Time between two calls of the controller, s; 0: every tick. It counts only if the controller uses no
  /// devices and the type has no drive. Otherwise, the controller has the period of the first device that it
  /// uses or, if it uses none, of the drive.
  double period = 0;
  engine::Record params;  ///< one value per parameter of the kind (ControllerKind::params)
  static void describe(DocumentKeys<ControllerDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A part of a body: a rigid piece with a pose in the frame of the body. TypeDocument uses these members for
/// the body itself.
struct PartDocument : Placed {
  std::string name;   ///< name of the part or type; empty for a type that is named like its key
  std::string alias;  ///< another name, by which programs can also find the part; empty: none
  /// Model type of Stage that corresponds to the part: a name in Registry::models. (Stage is an older robot
  /// simulator, whose files Troupe reads and writes.) Empty: "position" for a type with a drive, else
  /// "model".
  std::string kind;
  std::optional<Pose> pose;        ///< pose in the frame of the body; empty: at the origin of the body
  std::optional<JointName> joint;  ///< joint that moves the part; empty: that of the enclosing part
  /// The image that gives the part its shape. If image.bitmap is empty, the part has no image, and image.size
  /// has another meaning. With `fit`, it is the size to which `blocks` are scaled. Without `fit`, it is the
  /// size of a box on z = 0 that is centred on the origin of the part; without image.size, there is no box.
  ImageDocument image;
  bool fit = false;  ///< true: the blocks together are scaled to image.size
  /// With an image or `fit`: pose of the centre of the scaled image or blocks, in the frame of the part. With
  /// a ROS map: pose of the frame of the map.
  std::optional<Pose> origin;
  std::optional<DiscDocument> disc;  ///< a cylinder about the origin of the part, in addition to the blocks
  std::optional<std::vector<BlockDocument>> blocks;  ///< upright prisms
  std::optional<bool> floor_plan;  ///< whether the shape is that of walls; empty: true if it is an image
  /// Size [x, y, height] of the part, m, that fiducial finders report and that controllers can read. Empty:
  /// the size of the shape.
  std::optional<Eigen::Vector3d> extent;
  std::optional<Color> color;                    ///< colour of the part; empty: that of the body
  engine::Returns returns;                       ///< how other bodies collide with the part and sense it
  std::optional<OwnDeviceDocument> device;       ///< if the part itself is a device: this device
  std::vector<SensorDocument> sensors;           ///< devices that only observe the world
  std::vector<DeviceDocument> devices;           ///< all other devices
  std::optional<ControllerDocument> controller;  ///< the only controller; excludes `controllers`
  std::vector<ControllerDocument> controllers;   ///< several controllers, in order; excludes `controller`
  std::vector<PartDocument> parts;               ///< parts mounted on this part
  static void describe(DocumentKeys<PartDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A type: the properties that bodies of the same construction share. The members of the base PartDocument
/// describe the body itself, the root of the tree of parts.
struct TypeDocument : PartDocument {
  std::optional<DriveDocument> drive;  ///< drive; empty: the bodies do not move by themselves
  std::optional<std::vector<std::string>> device_order;  ///< names of all devices, in the order in which
                                                         ///< controllers choose among them; empty: file order
  static void describe(DocumentKeys<TypeDocument>& d);   ///< adds the keys of this struct to `d`
};

/// A floor plan: a body that consists of walls, with a type of its own. The walls are given as an image, as a
/// ROS map or as a line.
struct FloorplanDocument : Placed {
  std::string name;     ///< name of the body and of its type
  ImageDocument image;  ///< image of the walls; without a bitmap, only its height is used
  /// Points of the line along the middle of the walls, m, in the frame of `pose`. A floor plan has either
  /// this line or an image.
  std::optional<Ring> walls;
  double thickness = 0.1;  ///< thickness of the walls along the line, m
  /// Pose in the world frame: of the centre of the scaled image, of the frame of a ROS map, or of the frame
  /// of the points `walls`.
  Pose pose;
  std::optional<Color> color;  ///< colour of the walls; empty: dark grey, (0.3, 0.3, 0.3)
  engine::Returns returns;     ///< how other bodies collide with the walls and sense them
  static void describe(DocumentKeys<FloorplanDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A rectangular arena, centred on the origin of the world. It extends the bounds of the world, the box in
/// which the origins of bodies must stay. Four walls enclose it: they are a static body with the name
/// `arena`. If `walls` is false, there is no such body.
struct ArenaDocument : Placed {
  std::optional<std::array<double, 2>> size;  ///< free floor along x and y, m; required
  bool walls = true;                          ///< false: no walls, only bounds
  double height = 0.5;                        ///< height of the walls, m
  double thickness = 0.1;      ///< thickness of the walls, which stand outside the free floor, m
  std::optional<Color> color;  ///< colour of the walls; empty: dark grey, (0.3, 0.3, 0.3)
  static void describe(DocumentKeys<ArenaDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A single body.
struct ModelDocument : Placed {
  std::string name;   ///< name of the body; unique, unless WorldDocument::same_names allows repetitions
  std::string alias;  ///< another name, by which programs can also find the body; empty: none
  std::string type;   ///< a key of WorldDocument::types
  /// Name of the population to whose reserve the body belongs; empty: the body exists from the start.
  std::string reserve_of;
  Pose pose;                   ///< pose in the world frame
  std::optional<Color> color;  ///< colour of the body; empty: that of its type
  /// Number that fiducial finders read from the body; empty: that of its type.
  std::optional<std::int32_t> fiducial_return;
  /// Names of parts of this body that programs can look up without the body's name.
  std::vector<std::string> global_parts;
  static void describe(DocumentKeys<ModelDocument>& d);  ///< adds the keys of this struct to `d`
};

/// The heading of a population's bodies.
struct HeadingDocument {
  bool is_random = false;  ///< true: each body gets a random heading
  double rad = 0;          ///< if not random: the heading of all bodies, rad, world frame
};

/// The colour of a population's bodies.
struct ColorDocument {
  bool is_random = false;  ///< true: each body gets a random colour
  Color color;             ///< if not random: the colour of all bodies
};

/// The rule by which the bodies of a population are placed, and its parameters. A comment that begins with
/// the name of a rule, such as `grid:`, describes a parameter that only this rule has.
struct PlaceDocument : Placed {
  std::optional<engine::PlacementRule::Kind> rule;  ///< the rule: grid, uniform, ...; required
  /// Rectangle in which the origins of the bodies lie, m, world frame. Empty: the bounding box of `polygon`
  /// or, without a polygon, the bounds of the world.
  std::optional<Box> region;
  std::optional<Ring> polygon;                ///< polygon in which the origins also lie, m; empty: no polygon
  std::optional<Box> spill;                   ///< grid: region for bodies that do not fit in `region`, m
  std::optional<double> pitch;                ///< grid: distance between neighbouring cells, m; required
  double jitter = 0;                          ///< grid: maximum random displacement of each coordinate, m
  std::optional<std::array<double, 2>> mean;  ///< gaussian: mean of the origins, m; required
  /// gaussian: standard deviations of the origins along x and y, m; required.
  std::optional<std::array<double, 2>> deviation;
  std::optional<double> distance;  ///< poisson_disc: minimum distance of two origins, m; required
  /// free_floor: a point, m, world frame. The bodies are placed only on floor that can be reached from this
  /// point. Empty: on the largest connected area of floor.
  std::optional<std::array<double, 2>> from;
  /// free_floor: cell size of the search for reachable floor, m. Empty: half the radius of a body of the
  /// population, but at least 0.02 m.
  std::optional<double> cell;
  std::optional<HeadingDocument> heading;  ///< heading of the bodies; empty: 0 on a grid, else random
  double z = 0;                            ///< height of the origins, m, world frame
  static void describe(DocumentKeys<PlaceDocument>& d);  ///< adds the keys of this struct to `d`
};

/// Bodies of one type, placed by a rule.
struct PopulationDocument : Placed {
  std::string name;                    ///< name of the population; its bodies are called NAME0, ...
  std::string type;                    ///< a key of WorldDocument::types
  std::optional<std::int64_t> count;   ///< number of bodies; required
  std::int64_t reserve = 0;            ///< number of further bodies that may enter the world (be born) later
  std::optional<ColorDocument> color;  ///< colours; empty: the type's colour
  std::optional<PlaceDocument> place;  ///< how the bodies are placed; required
  static void describe(DocumentKeys<PopulationDocument>& d);  ///< adds the keys of this struct to `d`
};

// ---- measures and experiments

/// A measure that a run computes.
struct MeasureDocument : Placed {
  std::string kind;       ///< name of a kind in Registry::measures
  std::string of;         ///< the type, population or robot that is measured; empty: all robots
  std::string name;       ///< name of the column of results; empty: KIND, or KIND:OF if `of` is given
  engine::Record params;  ///< one value per parameter of the kind (MeasureKind::params)
  static void describe(DocumentKeys<MeasureDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A comparison with a number, such as `>= 0.9`.
struct ComparisonDocument {
  engine::Comparison how = engine::Comparison::below;  ///< the operator, such as `>=`
  double with = 0;                                     ///< the number, in the unit of the measure
};

/// A condition on a measure, such as `coverage >= 0.9`.
struct ConditionDocument : Placed {
  std::optional<MeasureDocument> measure;  ///< the measure whose value is compared; required
  std::optional<ComparisonDocument> is;    ///< the comparison that must hold; required
  static void describe(DocumentKeys<ConditionDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A group of bodies: all bodies of a population, all bodies of a type, or a single body. Exactly one of
/// `population`, `type` and `model` is given. If `count` or `share` is given, the group is a random selection
/// of these bodies. At most one of `count` and `share` is given.
struct GroupDocument : Placed {
  std::optional<std::string> population;  ///< name of a population
  std::optional<std::string> type;        ///< a key of WorldDocument::types
  std::optional<std::string> model;       ///< the name of one body
  std::optional<std::int64_t> count;      ///< number of bodies to select at random, or all if there are fewer
  /// Fraction of the bodies to select at random, 0 to 1. The number of bodies is rounded to the nearest
  /// integer, halves up: 0.5 of 5 bodies are 3 bodies.
  std::optional<double> share;
  static void describe(DocumentKeys<GroupDocument>& d);  ///< adds the keys of this struct to `d`
};

/// Births: bodies of the reserve of a population enter the world.
struct AddDocument : Placed {
  std::string population;             ///< name of a population with a reserve
  std::optional<std::int64_t> count;  ///< number of births; empty: all bodies that remain in the reserve
  std::optional<Pose> pose;           ///< pose of each new body, world frame; empty: random
  std::optional<Box> region;          ///< region of random poses, m; empty: the world's bounds
  static void describe(DocumentKeys<AddDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A change of the pose of a body.
struct MoveDocument : Placed {
  std::string model;                                    ///< name of the body
  std::optional<Pose> pose;                             ///< new pose, in the world frame; required
  static void describe(DocumentKeys<MoveDocument>& d);  ///< adds the keys of this struct to `d`
};

/// New parameters of the drive, a device or a controller, for all bodies of a type. Exactly one of `drive`,
/// `device` and `controller` is given. Its value is stored as a JSON node, because the valid parameters
/// depend on the type.
struct SettingDocument : Placed {
  std::string type;                                        ///< a key of WorldDocument::types
  std::optional<JsonNode> drive;                           ///< new parameters of the drive
  std::optional<JsonNode> device;                          ///< `name` of a device, and its new parameters
  std::optional<JsonNode> controller;                      ///< `kind` of a controller, and its new parameters
  static void describe(DocumentKeys<SettingDocument>& d);  ///< adds the keys of this struct to `d`
};

/// An intervention: a change of the world at a given time. Exactly one of the members after `time` is given.
struct InterventionDocument : Placed {
  std::optional<double> time;            ///< simulated time, s, rounded up to the end of a tick; required
  std::optional<GroupDocument> remove;   ///< bodies that leave the world
  std::optional<AddDocument> add;        ///< bodies of a reserve that enter the world
  std::optional<GroupDocument> disable;  ///< bodies whose drives, controllers and devices stop
  std::optional<GroupDocument> enable;   ///< disabled bodies whose drives, controllers and devices restart
  std::optional<MoveDocument> move;      ///< a body and its new pose
  std::optional<SettingDocument> set;    ///< new parameters of a type
  static void describe(DocumentKeys<InterventionDocument>& d);  ///< adds the keys of this struct to `d`
};

/// Faults (failures during the run) that can occur in the bodies of a group, each independently of the
/// others.
struct FaultDocument : GroupDocument {
  /// A kind of fault, with its parameters.
  struct Impairment {
    std::string kind;       ///< name in Registry::faults
    engine::Record params;  ///< one value per parameter of the kind (FaultKind::params)
  };
  double from = 0;                      ///< earliest simulated time at which a fault occurs, s
  std::vector<Impairment> impairments;  ///< kinds of faults, at least one
  static void describe(DocumentKeys<FaultDocument>& d);  ///< adds the keys of this struct to `d`
};

/// Stop conditions, interventions and faults.
struct ExperimentDocument : Placed {
  std::vector<ConditionDocument> stop_when;  ///< the run ends when any of these conditions holds
  std::vector<InterventionDocument> at;      ///< interventions, in any order
  std::vector<FaultDocument> faults;         ///< faults, which only bodies that exist at the start can have
  static void describe(DocumentKeys<ExperimentDocument>& d);  ///< adds the keys of this struct to `d`
};

// ---- the world

/// What a run records.
struct RecordDocument : Placed {
  /// Path of the recording that `troupe run` writes, relative to the working folder. The file must be in or
  /// below this folder. Empty: a run records only if `--record` names a file.
  std::string file;
  std::optional<double> every;  ///< simulated time between two recorded states, s, above 0; empty: 0.1 s
  /// Names of fields of the state, such as "pose" or "eye.ranges", to record; empty: only the poses.
  std::vector<std::string> fields;
  static void describe(DocumentKeys<RecordDocument>& d);  ///< adds the keys of this struct to `d`
};

/// Properties of the ground, a body without a shape that is body 0 of every world.
struct GroundDocument : Placed {
  std::string alias;                                      ///< another name of the ground; required
  static void describe(DocumentKeys<GroundDocument>& d);  ///< adds the keys of this struct to `d`
};

/// A whole world.
struct WorldDocument : Placed {
  /// Whether a problem is an error or a warning. The problems are bodies that overlap at the start, and
  /// bodies with the same name. expand(), which makes the spec of the document, reports both. However,
  /// warnings about overlaps come from the constructor of engine::World.
  enum class Check : std::uint8_t {
    error,  ///< an overlap or a repeated name is an error
    warn,   ///< an overlap or a repeated name is a warning
  };
  std::shared_ptr<SourceFiles> files;  ///< the files to which the places (Where) refer; null: none
  std::string schema;                  ///< value of the key `$schema`, which names a JSON schema for editors
  std::string title;                   ///< title; empty: the file's name without its ending
  std::uint64_t seed = 1;              ///< seed of all random numbers
  double tick = 0.1;                   ///< length of a tick (one time step), s
  std::optional<double> quit_time;     ///< simulated time at which a run ends, s; empty: no end
  double measure_every = 1;            ///< simulated time between measurements, s; 0: every tick
  engine::RangingEngine ranging = engine::RangingEngine::exact;  ///< method of computing ranges
  /// Edge length of the cells of the grid in which ranges are computed, m. Used only if `ranging` is
  /// RangingEngine::grid.
  double resolution = engine::k_resolution_m;
  /// Box in which the origins of bodies must stay, m, world frame. Empty: the bounding box of the floor plans
  /// and the arena.
  std::optional<Box> bounds;
  std::optional<GroundDocument> ground;  ///< properties of the ground
  std::optional<RecordDocument> record;  ///< what a run records
  /// Settings for watching a run: a limit of its speed, and whether it prints the simulated time. The record
  /// has one value for each field of engine::watch_fields().
  std::optional<engine::Record> watch;
  /// Settings of the view that the option `--camera window` selects. The record has one value for each field
  /// of window_fields().
  std::optional<engine::Record> window;
  /// True: programs that use Troupe as a library may remove and disable bodies. False: they may do so only in
  /// certain worlds. To remove bodies, the world must have a reserve, or something that removes bodies, such
  /// as an intervention. To disable bodies, it must have faults, or interventions that disable or enable
  /// bodies.
  bool mortal = false;
  /// Whether the state says what blocked each body (engine::WorldSpec::contacts).
  bool contacts = false;
  Check overlaps = Check::error;              ///< how a model that overlaps a body at the start is treated
  Check same_names = Check::error;            ///< how bodies with the same name are treated
  std::vector<FloorplanDocument> floorplans;  ///< walls, as images or lines
  std::optional<ArenaDocument> arena;         ///< a rectangular floor, usually with walls
  std::vector<std::pair<std::string, TypeDocument>> types;  ///< types, each with its key
  std::vector<ModelDocument> models;                        ///< single bodies
  std::vector<PopulationDocument> populations;              ///< bodies placed by rules
  std::vector<MeasureDocument> measures;                    ///< what a run measures
  ExperimentDocument experiment;  ///< the keys of this struct are keys of the world itself
  static void describe(DocumentKeys<WorldDocument>& d);  ///< adds the keys of this struct to `d`
};

}  // namespace troupe::worldio
