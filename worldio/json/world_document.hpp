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
#include "worldio/json/json_document.hpp"

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
/// place where it stands. expand() makes an engine::WorldSpec of it, contract() makes it of one. The keys, their
/// units, limits and meanings are in the descriptions (world_document.cpp) and in docs/world-format.md.
namespace troupe::worldio {

template <class T>
class DocumentKeys;

inline constexpr std::int64_t k_format_version = 1;
inline constexpr double k_max_size_m = 100000;  ///< how far worlds reach
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
  std::optional<std::string> name;
};

// ---- bodies

/// What stands on the floor plan or on a part: an upright prism.
struct BlockDocument : Placed {
  /// Whose frame points are in.
  enum class Frame : std::uint8_t { part, body };
  std::optional<Ring> points;                 ///< the outline, m; or:
  std::optional<std::vector<Ring>> contours;  ///< m: what lies within an odd number of them is solid
  std::optional<std::array<double, 2>> z;     ///< the heights between which it stands, m; required
  Frame frame = Frame::part;
  static void describe(DocumentKeys<BlockDocument>& d);
};

/// An image, or a map of ROS, from which a body is made.
struct ImageDocument {
  enum class Margins : std::uint8_t { trim, keep };
  enum class Unknown : std::uint8_t { free, solid };
  std::string bitmap;                       ///< its path, relative to the world's file; empty: there is none
  std::optional<Eigen::Vector3d> size;      ///< m; of a map its own
  std::optional<double> height;             ///< of a map: of its walls, m; not given: 1
  Unknown unknown = Unknown::free;          ///< of a map: what cells are that were never seen
  Margins margins = Margins::trim;          ///< what of an image fills the size
  bool boundary = false;                    ///< four walls just inside the edges
};

/// A device that a body carries: a sensor or another.
struct DeviceDocument : Placed {
  std::string name;             ///< empty: generated, as "ranger:0"
  std::string kind;
  bool is_kind_implied = false;  ///< the kind follows from that of the part around it
  std::optional<Pose> pose;     ///< in the frame of what it stands on
  std::optional<JointName> joint;  ///< that it moves with; not given: that of its part
  bool active = true;           ///< runs without a subscriber
  double period = 0;            ///< s; 0: every tick
  engine::Record params;        ///< by the kind's field table, complete
  std::string on;               ///< the device that it stands on; empty: the part
  std::optional<Color> color;   ///< of what it shows, as those that follow; for kinds with joints
  engine::Returns returns;
  std::optional<Eigen::Vector3d> size;
  std::vector<BlockDocument> blocks;
  static void describe(DocumentKeys<DeviceDocument>& d);  ///< one that is no sensor
};
/// A device of the list `sensors`.
struct SensorDocument : DeviceDocument {
  static void describe(DocumentKeys<SensorDocument>& d);
};
/// The device that a part itself is.
struct OwnDeviceDocument : DeviceDocument {
  static void describe(DocumentKeys<OwnDeviceDocument>& d);
};

struct DriveDocument : Placed {
  std::string kind;
  double period = 0;      ///< s; 0: every tick
  engine::Record params;  ///< by the kind's field table, complete
  static void describe(DocumentKeys<DriveDocument>& d);
};

struct ControllerDocument : Placed {
  std::string kind;
  double period = 0;      ///< s; 0: every tick
  engine::Record params;  ///< by the kind's field table, complete
  static void describe(DocumentKeys<ControllerDocument>& d);
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
  std::optional<std::vector<BlockDocument>> blocks;
  std::optional<bool> floor_plan;         ///< not given: where it is an image
  std::optional<Eigen::Vector3d> extent;  ///< the size as declared, m, where it is another
  std::optional<Color> color;             ///< not given: the body's
  engine::Returns returns;
  std::optional<OwnDeviceDocument> device;
  std::vector<SensorDocument> sensors;
  std::vector<DeviceDocument> devices;
  std::optional<ControllerDocument> controller;  ///< or:
  std::vector<ControllerDocument> controllers;
  std::vector<PartDocument> parts;  ///< that stand on it
  static void describe(DocumentKeys<PartDocument>& d);
};

/// What identical bodies share; its part is the root.
struct TypeDocument : PartDocument {
  std::optional<DriveDocument> drive;  ///< none: it does not move by itself
  std::optional<std::vector<std::string>> device_order;
  static void describe(DocumentKeys<TypeDocument>& d);
};

struct FloorplanDocument : Placed {
  std::string name;
  ImageDocument image;
  Pose pose;                   ///< of the centre
  std::optional<Color> color;
  engine::Returns returns;
  static void describe(DocumentKeys<FloorplanDocument>& d);
};

struct ModelDocument : Placed {
  std::string name;
  std::string alias;                           ///< empty: none
  std::string type;                            ///< a key of WorldDocument::types
  std::string reserve_of;                      ///< empty: it is there from the start
  Pose pose;
  std::optional<Color> color;                  ///< not given: the type's
  std::optional<std::int32_t> fiducial_return;  ///< its own number
  std::vector<std::string> global_parts;       ///< parts that are found without the body's name
  static void describe(DocumentKeys<ModelDocument>& d);
};

/// How a population is placed.
struct PlaceDocument : Placed {
  struct Heading {
    bool is_random = false;
    double rad = 0;
  };
  std::optional<engine::PlacementRule::Kind> rule;  ///< required
  std::optional<Box> region;                        ///< of the origins, m
  std::optional<Ring> polygon;                      ///< of the origins, m
  std::optional<Box> spill;
  std::optional<double> pitch;
  double jitter = 0;
  std::optional<std::array<double, 2>> mean;
  std::optional<std::array<double, 2>> deviation;
  std::optional<double> distance;
  std::optional<std::array<double, 2>> from;
  std::optional<double> cell;
  std::optional<Heading> heading;
  double z = 0;
  static void describe(DocumentKeys<PlaceDocument>& d);
};

struct PopulationDocument : Placed {
  struct BodyColor {
    bool is_random = false;
    Color color;
  };
  std::string name;
  std::string type;
  std::optional<std::int64_t> count;  ///< required
  std::int64_t reserve = 0;
  std::optional<BodyColor> color;       ///< not given: the type's
  std::optional<PlaceDocument> place;   ///< required
  static void describe(DocumentKeys<PopulationDocument>& d);
};

// ---- what is measured, and what happens

struct MeasureDocument : Placed {
  std::string kind;
  std::string of;         ///< a type, a population or a robot; empty: all robots
  std::string name;       ///< of the column; empty: the kind's
  engine::Record params;  ///< by the kind's field table, complete
  static void describe(DocumentKeys<MeasureDocument>& d);
};

struct ConditionDocument : Placed {
  struct Comparison {
    engine::Comparison how = engine::Comparison::below;
    double with = 0;
  };
  std::optional<MeasureDocument> measure;  ///< required
  std::optional<Comparison> is;            ///< required
  static void describe(DocumentKeys<ConditionDocument>& d);
};

/// Some bodies: one of the names is given.
struct GroupDocument : Placed {
  std::optional<std::string> population, type, model;
  std::optional<std::int64_t> count;
  std::optional<double> share;
  static void describe(DocumentKeys<GroupDocument>& d);
};

struct AddDocument : Placed {
  std::string population;
  std::optional<std::int64_t> count;
  std::optional<Pose> pose;
  std::optional<Box> region;  ///< m
  static void describe(DocumentKeys<AddDocument>& d);
};

struct MoveDocument : Placed {
  std::string model;
  std::optional<Pose> pose;  ///< required
  static void describe(DocumentKeys<MoveDocument>& d);
};

/// Parameters of a type that change. What there is depends on the type, so that they are kept as they stand.
struct SettingDocument : Placed {
  std::string type;                ///< a key of WorldDocument::types
  std::optional<JsonNode> drive;   ///< one of these three: an object
  std::optional<JsonNode> device;  ///< with `name`
  std::optional<JsonNode> controller;  ///< with `kind`
  static void describe(DocumentKeys<SettingDocument>& d);
};

/// An entry of `at`: one of the actions is given.
struct InterventionDocument : Placed {
  std::optional<double> time;  ///< s; required
  std::optional<GroupDocument> remove;
  std::optional<AddDocument> add;
  std::optional<GroupDocument> disable;
  std::optional<GroupDocument> enable;
  std::optional<MoveDocument> move;
  std::optional<SettingDocument> set;
  static void describe(DocumentKeys<InterventionDocument>& d);
};

struct FaultDocument : GroupDocument {
  struct Impairment {
    std::string kind;
    engine::Record params;  ///< by the kind's field table, complete
  };
  double from = 0;                      ///< s
  std::vector<Impairment> impairments;  ///< at least one
  static void describe(DocumentKeys<FaultDocument>& d);
};

/// When a run is over, and what happens in it.
struct ExperimentDocument : Placed {
  std::vector<ConditionDocument> stop_when;
  std::vector<InterventionDocument> at;
  std::vector<FaultDocument> faults;
  static void describe(DocumentKeys<ExperimentDocument>& d);
};

// ---- the world

struct RecordDocument : Placed {
  std::string file;
  std::optional<double> every;  ///< s
  std::vector<std::string> fields;
  static void describe(DocumentKeys<RecordDocument>& d);
};

struct GroundDocument : Placed {
  std::string alias;
  static void describe(DocumentKeys<GroundDocument>& d);
};

/// A whole world.
struct WorldDocument : Placed {
  /// What a finding of a check is.
  enum class Check : std::uint8_t { error, warn };
  std::shared_ptr<SourceFiles> files;  ///< what places point into; null: there are none
  std::string schema;  ///< `$schema`, of editors
  std::string title;   ///< empty: the file's name
  std::uint64_t seed = 1;
  double tick = 0.1;                ///< s
  std::optional<double> quit_time;  ///< s
  double measure_every = 1;         ///< s
  engine::RangingEngine ranging = engine::RangingEngine::exact;
  double resolution = engine::k_resolution_m;  ///< m
  std::optional<Box> bounds;                   ///< m
  std::optional<GroundDocument> ground;
  std::optional<RecordDocument> record;
  std::optional<engine::Record> watch;   ///< by engine::watch_fields()
  std::optional<engine::Record> window;  ///< by window_fields()
  bool mortal = false;
  Check overlaps = Check::error;
  Check same_names = Check::error;
  std::vector<FloorplanDocument> floorplans;
  std::vector<std::pair<std::string, TypeDocument>> types;
  std::vector<ModelDocument> models;
  std::vector<PopulationDocument> populations;
  std::vector<MeasureDocument> measures;
  ExperimentDocument experiment;  ///< its keys are the world's own
  static void describe(DocumentKeys<WorldDocument>& d);
};

}  // namespace troupe::worldio
