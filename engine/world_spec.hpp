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

// What a world file says, expanded: plain data that a loader makes from any format, that a program can fill
// by hand, and that engine::World is built from. Lengths in metres, angles in radians, times in seconds.

/// The most corners that the outlines of a world may have: of all its types, and of all its bodies that never
/// move.
inline constexpr std::size_t k_most_vertices = 50000000;

/// How a model shows itself to others.
struct Returns {
  bool obstacle = true;       ///< takes part in collisions
  float ranger = 1;           ///< below 0: rays pass; else the intensity a ranger reads
  std::int32_t fiducial = 0;  ///< what fiducial finders read, or BodySpec::fiducial; 0: they do not find it
  std::int32_t fiducial_key = 0;  ///< of the finders that may find it
  bool gripper = false;           ///< grippers feel it, and can take it
  bool pushable = false;          ///< robots that drive into it push the whole body: docs/pushing.md
  bool blob = true;               ///< blob finders see its colour; else it only hides what is behind
  friend bool operator==(const Returns&, const Returns&) = default;
};

/// No joint: rigid with the body.
inline constexpr std::int32_t k_rigid = -1;

/// A frame of a type that one of its devices moves: an actuator's, a gripper's paddle's. What stands on it
/// (parts, devices, further joints) is described where it is while every joint is at rest.
struct JointSpec {
  std::string name;               ///< of its component, `joint/<name>`
  std::int32_t parent = k_rigid;  ///< index of the joint that it stands on, which comes before it
  Pose pose_body_joint;           ///< at rest; the joint moves in this frame
};

/// The image that a part's solids are made from: for who writes the world again, since all else is in them.
struct ImageSpec {
  std::string file;               ///< as it was found; of a map of ROS its YAML
  bool keeps_margins = false;     ///< the whole image fills the part's size, not only what of it is solid
  bool unknown_is_solid = false;  ///< of a map: cells that are unknown
  bool boundary = false;          ///< four walls stand just inside its edges
  Pose origin;                    ///< of the image's middle, or of a map's frame, in the part's frame
  friend bool operator==(const ImageSpec&, const ImageSpec&) = default;
};

/// The blocks that a part's solids are made from, as Stage does it: stretched together to fill the part's
/// size, centred in x and y, and put at `origin` in the part's frame. Kept for the same reason.
struct FittedBlocks {
  std::vector<Solid> blocks;  ///< in one frame of their own, in any unit of length
  Pose origin;                ///< where their middle comes to lie
};

/// One model of a type's tree.
struct PartSpec {
  std::string name;                     ///< below the body's name: "ranger:0"; empty for the root (part 0)
  std::string alias;                    ///< its generated name, where the world gave it another; else empty
  std::string kind;                     ///< model kind: "position", "ranger", ...
  std::uint32_t parent = 0;             ///< index of the part it stands on; the root's own is 0
  std::int32_t joint = k_rigid;         ///< index of the joint that it moves with
  Pose pose_body_part;                  ///< of the part's own frame
  Eigen::Vector3d size{0.4, 0.4, 1.0};  ///< as declared; what GetGeom gives in Stage
  std::vector<Solid> solids;            ///< in the body's frame, scaled, z included
  Returns returns;                      ///< how others meet and see it
  bool floor_plan = false;              ///< outlined by an image
  std::optional<ImageSpec> image;       ///< of what image; none: it was not made from one
  std::optional<FittedBlocks> fitted;   ///< of which blocks; none: its solids are as they were given
  std::optional<Color> color;           ///< not given: the body's own
  Where where;                          ///< for messages
};

/// A device that each body of a type carries.
struct DeviceSpec {
  std::string name;              ///< of the part that carries it, or as the type names it
  std::string kind;              ///< of Registry::devices
  std::uint32_t part = 0;        ///< index of the part that carries it
  std::int32_t joint = k_rigid;  ///< index of the joint that it stands on
  std::int32_t moves = k_rigid;  ///< index of the first of the joints that it moves (DeviceKind::joints)
  Record params;                 ///< by the kind's field table
  Pose pose_body_sensor;         ///< frame in which the kind's parameters are given
  double period_s = 0;           ///< 0: every tick
  bool active = true;            ///< runs without a subscriber
  Where where;                   ///< for messages
};

/// How bodies of a type move by themselves.
struct DriveSpec {
  std::string kind;     ///< of Registry::drives
  Record params;        ///< one for each field of the kind's table: FieldTable::defaults()
  double period_s = 0;  ///< 0: every tick
  Where where;          ///< for messages
};

/// What decides for bodies of a type.
struct ControllerSpec {
  std::string kind;        ///< of Registry::controllers, or a plug-in's
  std::uint32_t part = 0;  ///< index of the part it belongs to: it finds what that and those on it carry
  Record params;           ///< one for each field of the kind's table: FieldTable::defaults()
  double period_s = 0;     ///< of one that reads no sensor and has no drive; 0: every tick
  Where where;             ///< for messages
};

/// What identical bodies share.
struct TypeSpec {
  std::string name;                         ///< unique in the world
  std::vector<PartSpec> parts;              ///< depth first; part 0 is the root
  std::vector<JointSpec> joints;            ///< each after the one that it stands on
  std::optional<DriveSpec> drive;           ///< none: they do not move by themselves
  std::vector<DeviceSpec> devices;          ///< those that move a joint before those that stand on it
  std::vector<ControllerSpec> controllers;  ///< in the order in which they decide: the last word counts
};

/// One body of the world.
struct BodySpec {
  Name name;             ///< of WorldSpec::names
  TypeId type;           ///< index into WorldSpec::types
  Pose pose_world_body;  ///< at tick 0, with all joints at rest
  Color color;           ///< of parts without one of their own
  /// What fiducial finders read of its root, where its type's root is marked (Returns::fiducial): so that
  /// robots with numbers of their own are of one type. 0: what the type says.
  std::int32_t fiducial = 0;
  Where where;  ///< for messages
};

/// Bodies of a population that are not there at tick 0: [first, first + count), to be born one after another
/// (docs/lives.md). They are of one type; where they stand is said when they are born.
struct ReserveSpec {
  std::string population;   ///< whose it is: NAME of NAME0, NAME1, ...
  BodyId first;             ///< of the bodies that wait
  std::uint32_t count = 0;  ///< how many wait
};

/// A part of a body that the world gave a name of its own, not one below the body's.
struct PartName {
  BodyId body;       ///< that has the part
  std::string part;  ///< PartSpec::name
};

/// What the world wants recorded, where a run records (docs/recordings.md).
struct RecordSpec {
  std::string file;                 ///< empty: only where the command line names one
  std::vector<std::string> fields;  ///< empty: as by default
  std::optional<double> every_s;    ///< world time between two ticks that are kept; not given: 0.1
  Where where;                      ///< for messages
  Where where_fields;               ///< of `fields`, for messages
};

/// A whole world: what engine::World is built from. Who fills it by hand begins with add_ground().
struct WorldSpec {
  std::string title;                             ///< for people
  std::shared_ptr<SourceFiles> files;            ///< what the Where of each value points into; may be null
  std::uint64_t seed = 1;                        ///< of all random numbers and priorities
  double tick_s = 0.1;                           ///< length of a tick; above 0
  std::optional<double> quit_time_s;             ///< where runs end that say nothing else, world time
  std::optional<RecordSpec> record;              ///< none: it asks for no recording
  RangingEngine ranging = RangingEngine::exact;  ///< how rangers see: docs/sensing.md
  double resolution_m = k_resolution_m;          ///< edge of the grid engine's cells
  Where resolution_where;                        ///< of `resolution_m`, for messages
  /// Where robots may go; one that would leave is held. Not given: +-100 km.
  std::optional<Box> bounds;
  std::vector<TypeSpec> types;  ///< TypeId is the position in this list
  Names names;                  ///< the words that the bodies' names are made of
  /// BodyId is the position in this list. Body 0 is the ground: add_ground().
  std::vector<BodySpec> bodies;
  std::vector<ReserveSpec> reserves;  ///< rising, and apart from one another
  bool mortal = false;  ///< programs may remove and disable bodies, also where the world does not
  /// Other names of bodies (Stage keeps generated names as aliases), each once.
  std::vector<NamedBody> aliases;
  /// Parts with names of their own (Stage's `name "/x"` in a child).
  std::unordered_map<std::string, PartName> part_aliases;
  /// What a run measures, and how often, unless its options say otherwise.
  std::vector<MeasureSpec> measures;
  double measure_every_s = 1;    ///< seconds between two lines of measures
  WatchSpec watch;               ///< how it wants to be watched
  std::optional<Record> window;  ///< of the view it asks for: worldio/window_fields.hpp
  ExperimentSpec experiment;     ///< what is done to it as it runs

  /// Of a body, as text.
  std::string name(BodyId body) const { return names.text(bodies[body.index()].name); }
  /// Whether it is there at tick 0.
  bool starts(BodyId body) const {
    for (const ReserveSpec& reserve : reserves)
      if (body.value - reserve.first.value < reserve.count) return false;
    return true;
  }
};

/// The ground every world begins with: the body `_ground_model`, of type `ground`, without a solid.
void add_ground(WorldSpec& spec);

/// Reports what the members of a world say of one another and cannot be: a part that stands on a later one, a
/// body of a type that is not there, a reserve that overlaps another, ... Each message begins with the path
/// of the value: `types[0].parts[2].parent: ...`. The members themselves are described in
/// spec_description.cpp.
void check_rules(const WorldSpec& spec, const std::function<void(Where, const std::string&)>& report);

/// Gives each population of robots that has no reserve one of `count` bodies, behind all other bodies. A
/// population is here what is called NAME0, NAME1, ..., of one type with a drive.
void add_spare(WorldSpec& spec, std::uint32_t count);

/// What fiducial finders read of a part of a body; 0: they do not find it.
inline std::int32_t fiducial_of(const WorldSpec& spec, BodyId body, std::uint32_t part) {
  const BodySpec& b = spec.bodies[body.index()];
  const std::int32_t of_type = spec.types[b.type.index()].parts[part].returns.fiducial;
  return part == 0 && of_type != 0 && b.fiducial != 0 ? b.fiducial : of_type;
}

/// True when bodies of the type can move.
inline bool is_mobile(const TypeSpec& type) { return type.drive.has_value(); }

/// True when part `below` is `part` itself, stands on it, or on one that does.
bool is_below(const TypeSpec& type, std::uint32_t below, std::uint32_t part);

}  // namespace troupe::engine
