#pragma once

#include "base/color.hpp"
#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "engine/experiment_spec.hpp"
#include "engine/fields.hpp"
#include "engine/placement.hpp"
#include "engine/ranging_engine.hpp"
#include "engine/world_spec.hpp"
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

/// What a world in JSON says, as plain data: parts, bitmaps, populations, in SI units, each value with the
/// place where it stands. expand() makes an engine::WorldSpec of it, contract() makes it of one. The keys,
/// their units, limits and meanings are in the descriptions (world_document.cpp) and in docs/world-format.md.
namespace troupe::worldio {

/// Describes a struct of a document: worldio/json/document_table.hpp.
template <class T>
class DocumentKeys;

inline constexpr std::int64_t k_format_version = 1;       ///< the only one
inline constexpr double k_max_size_m = 100000;            ///< how far worlds reach
inline constexpr std::size_t k_most_block_points = 1000;  ///< the test for crossings is quadratic

/// Where an object of a document stands, and the values of its keys: for findings.
struct Placed {
  /// A key that is there, right or wrong.
  struct Key {
    std::string_view name;  ///< as described: without its unit
    Where where;            ///< of the value
  };
  Where where;            ///< where the object begins
  std::vector<Key> keys;  ///< in the order of the description

  bool says(std::string_view key) const;  ///< whether the key is there
  /// Of the value of a key; of the object where it is not there.
  Where where_of(std::string_view key) const;
};

/// The name of a joint; empty: none, which a file says with null.
struct JointName {
  std::optional<std::string> name;  ///< empty: none
};

// ---- bodies

/// What stands on the floor plan or on a part: an upright prism.
struct BlockDocument : Placed {
  /// Whose frame points are in.
  enum class Frame : std::uint8_t {
    part,  ///< of the part that has the block
    body,  ///< of its body
  };
  std::optional<Ring> points;                 ///< the outline, m; or:
  std::optional<std::vector<Ring>> contours;  ///< m: what lies within an odd number of them is solid
  std::optional<std::array<double, 2>> z;     ///< the heights between which it stands, m; required
  Frame frame = Frame::part;                  ///< of the points
  static void describe(DocumentKeys<BlockDocument>& d);  ///< its keys
};

/// An image, or a map of ROS, from which a body is made.
struct ImageDocument {
  /// What of an image fills the size.
  enum class Margins : std::uint8_t {
    trim,  ///< the box of what is solid
    keep,  ///< the whole image
  };
  /// What cells of a map are that were never seen.
  enum class Unknown : std::uint8_t {
    free,   ///< floor
    solid,  ///< walls
  };
  std::string bitmap;                   ///< its path, relative to the world's file; empty: there is none
  std::optional<Eigen::Vector3d> size;  ///< m; of a map its own
  std::optional<double> height;         ///< of a map: of its walls, m; not given: 1
  Unknown unknown = Unknown::free;      ///< of a map: what cells are that were never seen
  Margins margins = Margins::trim;      ///< what of an image fills the size
  bool boundary = false;                ///< four walls just inside the edges
};

/// A device that a body carries: a sensor or another.
struct DeviceDocument : Placed {
  std::string name;                     ///< empty: generated, as "ranger:0"
  std::string kind;                     ///< of Registry::devices
  bool is_kind_implied = false;         ///< the kind follows from that of the part around it
  std::optional<Pose> pose;             ///< in the frame of what it stands on
  std::optional<JointName> joint;       ///< that it moves with; not given: that of its part
  bool active = true;                   ///< runs without a subscriber
  double period = 0;                    ///< s; 0: every tick
  engine::Record params;                ///< by the kind's field table, complete
  std::string on;                       ///< the device that it stands on; empty: the part
  std::optional<Color> color;           ///< of what it shows, as those that follow; for kinds with joints
  engine::Returns returns;              ///< how others meet and see it
  std::optional<Eigen::Vector3d> size;  ///< a box of this size, m
  std::vector<BlockDocument> blocks;    ///< and blocks
  static void describe(DocumentKeys<DeviceDocument>& d);  ///< its keys
};
/// A device of the list `sensors`.
struct SensorDocument : DeviceDocument {
  static void describe(DocumentKeys<SensorDocument>& d);  ///< its keys
};
/// The device that a part itself is.
struct OwnDeviceDocument : DeviceDocument {
  static void describe(DocumentKeys<OwnDeviceDocument>& d);  ///< its keys
};

/// How bodies of a type move by themselves.
struct DriveDocument : Placed {
  std::string kind;                                      ///< of Registry::drives
  double period = 0;                                     ///< s; 0: every tick
  engine::Record params;                                 ///< by the kind's field table, complete
  static void describe(DocumentKeys<DriveDocument>& d);  ///< its keys
};

/// What decides for bodies of a type.
struct ControllerDocument : Placed {
  std::string kind;                                           ///< of Registry::controllers
  double period = 0;                                          ///< s; 0: every tick
  engine::Record params;                                      ///< by the kind's field table, complete
  static void describe(DocumentKeys<ControllerDocument>& d);  ///< its keys
};

/// A part of a type's tree.
struct PartDocument : Placed {
  std::string name;                ///< of a type: what it is called, where that is not its key
  std::string alias;               ///< another name; empty: none
  std::string kind;                ///< what Stage calls it; empty: as follows from the drive
  std::optional<Pose> pose;        ///< in the body's frame
  std::optional<JointName> joint;  ///< that it moves with; not given: that of the part around it
  ImageDocument image;             ///< its size is that of a box, or of the fitted blocks, too
  bool fit = false;                ///< the blocks are stretched to the size
  std::optional<Pose> origin;      ///< where the middle of the image or of the fitted blocks is
  std::optional<std::vector<BlockDocument>> blocks;     ///< upright prisms
  std::optional<bool> floor_plan;                       ///< not given: where it is an image
  std::optional<Eigen::Vector3d> extent;                ///< the size as declared, m, where it is another
  std::optional<Color> color;                           ///< not given: the body's
  engine::Returns returns;                              ///< how others meet and see it
  std::optional<OwnDeviceDocument> device;              ///< the device that it is itself
  std::vector<SensorDocument> sensors;                  ///< what only looks at the world
  std::vector<DeviceDocument> devices;                  ///< what does something
  std::optional<ControllerDocument> controller;         ///< or:
  std::vector<ControllerDocument> controllers;          ///< several
  std::vector<PartDocument> parts;                      ///< that stand on it
  static void describe(DocumentKeys<PartDocument>& d);  ///< its keys
};

/// What identical bodies share; its part is the root.
struct TypeDocument : PartDocument {
  std::optional<DriveDocument> drive;  ///< none: it does not move by itself
  std::optional<std::vector<std::string>>
      device_order;  ///< in which order the devices count; not given: as they stand
  static void describe(DocumentKeys<TypeDocument>& d);  ///< its keys
};

/// Walls that an image draws: a body with a type of its own.
struct FloorplanDocument : Placed {
  std::string name;                                          ///< of the body and of its type
  ImageDocument image;                                       ///< of the walls
  Pose pose;                                                 ///< of the centre
  std::optional<Color> color;                                ///< not given: a dark grey
  engine::Returns returns;                                   ///< how others meet and see it
  static void describe(DocumentKeys<FloorplanDocument>& d);  ///< its keys
};

/// A single body.
struct ModelDocument : Placed {
  std::string name;                                      ///< unique in the world
  std::string alias;                                     ///< empty: none
  std::string type;                                      ///< a key of WorldDocument::types
  std::string reserve_of;                                ///< empty: it is there from the start
  Pose pose;                                             ///< in the world's frame
  std::optional<Color> color;                            ///< not given: the type's
  std::optional<std::int32_t> fiducial_return;           ///< its own number
  std::vector<std::string> global_parts;                 ///< parts that are found without the body's name
  static void describe(DocumentKeys<ModelDocument>& d);  ///< its keys
};

/// The heading of a population's bodies.
struct HeadingDocument {
  bool is_random = false;  ///< each body draws its own
  double rad = 0;          ///< else of all bodies
};

/// The colour of a population's bodies.
struct ColorDocument {
  bool is_random = false;  ///< each body draws its own
  Color color;             ///< else of all bodies
};

/// How a population is placed.
struct PlaceDocument : Placed {
  std::optional<engine::PlacementRule::Kind> rule;  ///< required
  std::optional<Box> region;                        ///< of the origins, m
  std::optional<Ring> polygon;                      ///< of the origins, m
  std::optional<Box> spill;                         ///< grid: for the bodies that the region cannot hold, m
  std::optional<double> pitch;                      ///< grid: between neighbours, m
  double jitter = 0;                                ///< grid: how far each coordinate may be moved, m
  std::optional<std::array<double, 2>> mean;        ///< gaussian: about which they are distributed, m
  std::optional<std::array<double, 2>> deviation;   ///< gaussian: standard deviations, m
  std::optional<double> distance;                   ///< poisson_disc: how near two may be, m
  std::optional<std::array<double, 2>> from;        ///< free_floor: from where it is reached, m
  std::optional<double> cell;                       ///< free_floor: how finely it is looked at, m
  std::optional<HeadingDocument> heading;           ///< not given: 0 on a grid, else random
  double z = 0;                                     ///< height of the origins, m
  static void describe(DocumentKeys<PlaceDocument>& d);  ///< its keys
};

/// Bodies of one type that a rule places.
struct PopulationDocument : Placed {
  std::string name;                                           ///< bodies are called NAME0, NAME1, ...
  std::string type;                                           ///< a key of WorldDocument::types
  std::optional<std::int64_t> count;                          ///< required
  std::int64_t reserve = 0;                                   ///< how many more may be born
  std::optional<ColorDocument> color;                         ///< not given: the type's
  std::optional<PlaceDocument> place;                         ///< required
  static void describe(DocumentKeys<PopulationDocument>& d);  ///< its keys
};

// ---- what is measured, and what happens

/// A measure to be taken of the run.
struct MeasureDocument : Placed {
  std::string kind;       ///< of Registry::measures
  std::string of;         ///< a type, a population or a robot; empty: all robots
  std::string name;       ///< of the column; empty: the kind's
  engine::Record params;  ///< by the kind's field table, complete
  static void describe(DocumentKeys<MeasureDocument>& d);  ///< its keys
};

/// `>= 0.9`.
struct ComparisonDocument {
  engine::Comparison how = engine::Comparison::below;  ///< how the measure is compared
  double with = 0;                                     ///< a number, in the unit of the measure
};

/// A condition on a measure.
struct ConditionDocument : Placed {
  std::optional<MeasureDocument> measure;                    ///< required
  std::optional<ComparisonDocument> is;                      ///< required
  static void describe(DocumentKeys<ConditionDocument>& d);  ///< its keys
};

/// Some bodies: one of the names is given.
struct GroupDocument : Placed {
  std::optional<std::string> population;                 ///< NAME of NAME0, NAME1, ...; or:
  std::optional<std::string> type;                       ///< a key of WorldDocument::types; or:
  std::optional<std::string> model;                      ///< the name of one body
  std::optional<std::int64_t> count;                     ///< so many of them
  std::optional<double> share;                           ///< this share of them, 0 to 1
  static void describe(DocumentKeys<GroupDocument>& d);  ///< its keys
};

/// Births out of a reserve.
struct AddDocument : Placed {
  std::string population;                              ///< one that has a reserve
  std::optional<std::int64_t> count;                   ///< how many are born; not given: one
  std::optional<Pose> pose;                            ///< where they are born; or:
  std::optional<Box> region;                           ///< m
  static void describe(DocumentKeys<AddDocument>& d);  ///< its keys
};

/// A model that is put elsewhere.
struct MoveDocument : Placed {
  std::string model;                                    ///< the body that is put elsewhere
  std::optional<Pose> pose;                             ///< required
  static void describe(DocumentKeys<MoveDocument>& d);  ///< its keys
};

/// Parameters of a type that change. What there is depends on the type, so that they are kept as they stand.
struct SettingDocument : Placed {
  std::string type;                                        ///< a key of WorldDocument::types
  std::optional<JsonNode> drive;                           ///< one of these three: an object
  std::optional<JsonNode> device;                          ///< with `name`
  std::optional<JsonNode> controller;                      ///< with `kind`
  static void describe(DocumentKeys<SettingDocument>& d);  ///< its keys
};

/// An entry of `at`: one of the actions is given.
struct InterventionDocument : Placed {
  std::optional<double> time;                                   ///< s; required
  std::optional<GroupDocument> remove;                          ///< their lives end
  std::optional<AddDocument> add;                               ///< so many are born
  std::optional<GroupDocument> disable;                         ///< they stop
  std::optional<GroupDocument> enable;                          ///< what was disabled goes on
  std::optional<MoveDocument> move;                             ///< one is put elsewhere
  std::optional<SettingDocument> set;                           ///< parameters of a type change
  static void describe(DocumentKeys<InterventionDocument>& d);  ///< its keys
};

/// How some bodies fail.
struct FaultDocument : GroupDocument {
  /// One way in which they fail.
  struct Impairment {
    std::string kind;       ///< of Registry::faults
    engine::Record params;  ///< by the kind's field table, complete
  };
  double from = 0;                                       ///< s
  std::vector<Impairment> impairments;                   ///< at least one
  static void describe(DocumentKeys<FaultDocument>& d);  ///< its keys
};

/// When a run is over, and what happens in it.
struct ExperimentDocument : Placed {
  std::vector<ConditionDocument> stop_when;                   ///< the run is over when one of them holds
  std::vector<InterventionDocument> at;                       ///< in any order of time
  std::vector<FaultDocument> faults;                          ///< of robots that are there at the start
  static void describe(DocumentKeys<ExperimentDocument>& d);  ///< its keys
};

// ---- the world

/// What a run records.
struct RecordDocument : Placed {
  std::string file;                 ///< where a run records; empty: where its caller says
  std::optional<double> every;      ///< s
  std::vector<std::string> fields;  ///< what of the state; empty: as by default
  static void describe(DocumentKeys<RecordDocument>& d);  ///< its keys
};

/// What is said of the ground.
struct GroundDocument : Placed {
  std::string alias;                                      ///< another name of the ground
  static void describe(DocumentKeys<GroundDocument>& d);  ///< its keys
};

/// A whole world.
struct WorldDocument : Placed {
  /// What a finding of a check is.
  enum class Check : std::uint8_t {
    error,  ///< the world is refused
    warn,   ///< it is reported
  };
  std::shared_ptr<SourceFiles> files;  ///< what places point into; null: there are none
  std::string schema;                  ///< `$schema`, of editors
  std::string title;                   ///< empty: the file's name
  std::uint64_t seed = 1;              ///< of every random draw
  double tick = 0.1;                   ///< s
  std::optional<double> quit_time;     ///< s
  double measure_every = 1;            ///< s
  engine::RangingEngine ranging = engine::RangingEngine::exact;  ///< what finds ranges
  double resolution = engine::k_resolution_m;                    ///< m
  std::optional<Box> bounds;                                     ///< m
  std::optional<GroundDocument> ground;                          ///< the ground of the world
  std::optional<RecordDocument> record;                          ///< what a run records
  std::optional<engine::Record> watch;                           ///< by engine::watch_fields()
  std::optional<engine::Record> window;                          ///< by window_fields()
  bool mortal = false;                                           ///< programs may remove bodies
  Check overlaps = Check::error;              ///< what models are that overlap something at the start
  Check same_names = Check::error;            ///< what two bodies of one name are
  std::vector<FloorplanDocument> floorplans;  ///< walls drawn as images
  std::vector<std::pair<std::string, TypeDocument>> types;  ///< by name
  std::vector<ModelDocument> models;                        ///< single bodies
  std::vector<PopulationDocument> populations;              ///< many bodies of one type each
  std::vector<MeasureDocument> measures;                    ///< what a run measures
  ExperimentDocument experiment;                            ///< its keys are the world's own
  static void describe(DocumentKeys<WorldDocument>& d);     ///< its keys
};

}  // namespace troupe::worldio
