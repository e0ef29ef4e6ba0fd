#pragma once

#include "engine/kinds/mount.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/overlap.hpp"

#include <algorithm>
#include <any>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::engine {

/// A closed outline that rays may hit: a polygon, extruded over a height interval. Its vertices are the
/// elements `first` to `first + count - 1` of BodyType::outline_vertices.
struct RayOutline {
  std::uint32_t first = 0;  ///< index of its first vertex in BodyType::outline_vertices
  std::uint32_t count = 0;  ///< number of its vertices
  ZInterval z;              ///< height interval at rest, body frame, m
  /// Intensity that rangers (range sensors) read, from Returns::ranger of the part; below 0: beams of rangers
  /// pass through the outline.
  float ranger_return = 1;
  std::uint32_t part = 0;  ///< part of the body that the outline belongs to: index into TypeSpec::parts
  /// Number of the solid that the outline belongs to, unique in the type. All outlines of a solid together
  /// bound one region (even-odd rule): an outline inside another is a hole.
  std::uint32_t solid = 0;
  std::int32_t joint = k_rigid;  ///< joint that it is mounted on: index into BodyType::joints; k_rigid: none
};

/// A compiled TypeSpec (the description of a body type in the world file): the data that bodies of one type
/// share. It is constant during a run, except for parameters that an intervention (a change that the world
/// file lists for a given time) or a program sets (SettingSpec).
///
/// A *part* is a rigid piece of a body, and consists of *solids*, which are extruded polygons. A *joint* is a
/// movable mount for parts and devices. "At rest" means that every joint is in its rest pose. A *device* is a
/// sensor or an actuator on a part. A *kind* is the implementation of a device, a drive or a controller: a
/// table of functions, called hooks (engine/kinds/device_kind.hpp). The registry is the list of all kinds.
/// Time advances in *ticks*, steps of equal length.
///
/// The state of a world is stored in state tables. Some members are indices of such tables. make_body_type()
/// leaves these members unset; World sets them if the world has bodies of the type that have rows in the
/// tables (runs()).
struct BodyType {
  std::string name;  ///< name of the type (TypeSpec::name)
  /// Obstacle shape at rest, body frame. Empty if no part is an obstacle, and for types whose bodies are
  /// static (runs() is false). The obstacles of static bodies are in WorldState::scene, the static scene.
  partition::ObstacleShape obstacle;
  /// For each convex piece of `obstacle`, the index in `joints` of the joint that it is mounted on, or
  /// k_rigid. Empty if the type has no joints.
  std::vector<std::int32_t> obstacle_joints;
  /// Shape at rest of the parts that grippers can grip, body frame; empty if there are none.
  partition::ObstacleShape grip;
  /// For each convex piece of `grip`, the index in `joints` of the joint that it is mounted on, or k_rigid.
  /// Empty if no piece is mounted on a joint.
  std::vector<std::int32_t> grip_joints;
  std::vector<Vec2> outline_vertices;  ///< vertices of all outlines at rest, body frame, m
  /// Outlines that rangers see. In `outline_vertices`, their vertices precede those of `hidden_outlines`.
  std::vector<RayOutline> outlines;
  std::vector<RayOutline> hidden_outlines;  ///< outlines that rangers do not see, but other sensors do
  /// Radius of the circle about the body's origin that encloses, at rest, every outline and the origins of
  /// all parts that fiducial finders (sensors of markers) detect, m.
  double radius = 0;
  /// Upper bound on the distance by which shifts of joints can move a point of the body out of the circle of
  /// the radius `radius`, m. It is the sum, over all devices, of the largest shift of the joints of a device
  /// (DeviceKind::Prepared::joint_reach_m). It includes neither turns of joints, nor the motions of drive
  /// devices (DeviceKind::drives), which have no limit.
  double joint_reach = 0;
  std::vector<std::uint32_t> targets;  ///< indices of the parts that fiducial finders detect; ascending

  /// A joint of the type, compiled from its JointSpec.
  struct Joint {
    std::string name;       ///< name; the joint's state is the state table `joint/<name>`
    std::int32_t parent;    ///< index in `joints` of its parent joint, which precedes it; k_rigid: none
    Mount at_rest;          ///< frame of the joint at rest, in the body frame
    Mount to_body;          ///< inverse of `at_rest`: the body frame, in the frame of the joint at rest
    std::size_t table = 0;  ///< state table with the poses of the joint: index into World::tables()
  };
  std::vector<Joint> joints;  ///< joints of the type, in the order of TypeSpec::joints

  /// The drive of the type, compiled from its DriveSpec.
  struct Drive {
    const DriveKind* kind;      ///< kind of the drive; the registry owns it
    std::any data;              ///< the compiled parameters: result of DriveKind::prepare
    std::uint64_t period;       ///< ticks from one run of the drive to the next
    Localization localization;  ///< how the robots of the type estimate their poses
    /// State table of the odometry estimates: index into World::tables(). Not set: the robots have no
    /// odometry.
    std::optional<std::size_t> odometry_table = std::nullopt;
    /// Power supply of the drive: index into BodyType::devices. Not set: the drive always has power.
    std::optional<std::size_t> supply = std::nullopt;
    /// Largest number of pushable bodies that the robot can push at once, 0 to k_most_pushed.
    std::uint8_t pushes = 0;
    bool turns_when_blocked = false;  ///< whether a robot whose motion is blocked may turn on the spot
  };
  std::optional<Drive> drive;  ///< none: bodies of the type do not move on their own
  bool pushable = false;       ///< true: robots can push bodies of this type, which then has no drive

  /// A sensor or another device of the type, compiled from its DeviceSpec.
  struct Device {
    /// Name of the device, unique in the type: DeviceSpec::name, followed by `#2` (or `#3`, ...) if an
    /// earlier device of the type has that name.
    std::string name;
    const DeviceKind* kind;         ///< kind of the device; the registry owns it
    DeviceKind::Prepared prepared;  ///< result of prepare_device()
    std::uint64_t period;           ///< ticks from one run of the device to the next
    /// True: the device runs whether or not a program subscribes to its body (World::subscribe()). It is true
    /// if DeviceSpec::active is true, or if a controller uses the device.
    bool active;
    std::uint32_t part;  ///< part that carries it: index into TypeSpec::parts
    std::int32_t joint;  ///< joint that it is mounted on: index in `joints`; k_rigid: none
    /// Index in `joints` of the first joint that the device moves. The other joints that it moves follow this
    /// joint. k_rigid: the device moves no joint.
    std::int32_t moves;
    /// Number of its random stream: stream_id(kind->name, name), a hash of the two names.
    std::uint32_t stream;
    /// Power supply of the device: index into BodyType::devices. Not set: the device always has power.
    std::optional<std::size_t> supply;
    /// State table of its percepts (its readings or other state): index into World::tables().
    std::size_t table = 0;
    /// State table of its commands: index into World::tables(). Not set: the device takes no commands.
    std::optional<std::size_t> command_table;
    /// The bit in Command::off with which controllers switch the device off. 0: no controller can switch the
    /// device. Only the first 32 devices of a type can have a bit.
    std::uint32_t switch_bit = 0;

    /// Whether the device measures ranges. The first field of its percepts then holds one range per beam, m,
    /// as float.
    bool is_ranger() const { return !prepared.bearings.empty(); }
  };
  std::vector<Device> devices;  ///< sensors and other devices, in the order of TypeSpec::devices
  /// Indices of the devices that move joints, ascending. If add_device() has added the devices of the type, a
  /// device that moves a joint comes before the devices that are mounted on this joint.
  std::vector<std::size_t> joint_devices;
  /// Indices of the devices that feel collisions (DeviceKind::Prepared::feels_collisions), ascending.
  std::vector<std::size_t> collision_devices;
  /// Whether the bodies can carry other bodies: a device of the type, such as a gripper, can pick them up.
  bool carries = false;

  /// A controller of the type, compiled from its ControllerSpec.
  struct Controller {
    const ControllerKind* kind;  ///< kind of the controller; the registry owns it
    std::any data;               ///< result of prepare_controller(): ControllerKind::Prepared::data
    /// The devices that it uses, in the order in which its kind chose them: indices into BodyType::devices.
    std::vector<std::size_t> devices;
    /// Ticks from one decision to the next: the period of the first of `devices`. If `devices` is empty, it
    /// is the period of the body's drive. If there is no drive either, it follows from
    /// ControllerSpec::period_s.
    std::uint64_t period;
    /// Number of the controller's random stream: stream_id(KIND, INDEX), a hash of two texts. KIND is the
    /// name of the controller's kind, and INDEX is the index of the controller in TypeSpec::controllers.
    std::uint32_t stream;
    /// State table of its memories (one memory per body): index into World::tables(). Not set: the controller
    /// has no memory.
    std::optional<std::size_t> table;
    /// The drive device (DeviceKind::drives) that it commands: index into BodyType::devices. Not set: it
    /// commands the drive of the body, if there is one.
    std::optional<std::size_t> drive;
  };
  std::vector<Controller> controllers;  ///< in the order in which they decide (TypeSpec::controllers)

  /// Estimated memory that each body takes, bytes: for its outlines, the poses of its joints, the states of
  /// and commands to its devices, and the memories of its controllers.
  double row_bytes() const;
  /// Whether bodies of the type have a row in the state tables, which store all data that change during a
  /// run. Bodies have a row if they have a drive, a device or a controller, or if they can be gripped or
  /// pushed. All other bodies are static.
  bool runs() const { return drive || !devices.empty() || !controllers.empty() || !grip.empty() || pushable; }
  /// Whether the obstacle shape of a body can change. It can if the body has joints or can carry other
  /// bodies.
  bool is_composite() const { return !joints.empty() || carries; }
  /// Whether a controller of the type has the hook `bind_world`, the only hook that can read the drive.
  bool binds_controllers() const {
    return std::ranges::any_of(controllers, [](const Controller& each) { return each.kind->bind_world; });
  }
};

/// Returns the number of readings that a device with these parameters would have. It is the sum of the
/// parameters that count readings (Field::counts_readings), including those in lists of parameter blocks
/// (FieldType::records). Parameters without a value are skipped. Callers compare the result with a limit
/// before they call prepare_device(), which allocates memory for the readings.
///
/// table: the parameters of the device's kind
/// params: their values, in the order of the table
double samples_asked_for(const FieldTable& table, const Record& params);

/// Compiles a device of the type `spec` in the world `world`. Calls the hooks (functions) prepare, bind_part,
/// bind_world and reach_m of the kind in this order. Hooks that are null are skipped. Returns an error if a
/// hook returns an error or throws an exception. Never throws.
///
/// kind: the kind that device.kind names
/// device: the device; its parameters must be within the limits of the table DeviceKind::params
Result<DeviceKind::Prepared> prepare_device(const DeviceKind& kind, const DeviceSpec& device,
                                            const WorldSpec& world, const TypeSpec& spec);

/// Compiles a controller. Calls the hooks (functions) prepare and bind_world of the kind; bind_world may be
/// null. Returns an error if a hook returns an error or throws an exception. Never throws.
///
/// The hook prepare chooses the devices that the controller uses. It can choose devices on the part of the
/// controller and on parts that are mounted on this part, directly or through other parts. It cannot choose
/// drive devices (DeviceKind::drives). In the result, ControllerKind::Prepared::devices contains indices into
/// BodyType::devices.
///
/// spec: the body type of the controller
/// type: the same type, whose devices must already be compiled
/// claimed: one entry for each device of the type. On entry, true means that an earlier controller has
/// reserved the device. The function sets the entries of the devices that this controller reserves; it may do
/// so even if it returns an error.
Result<ControllerKind::Prepared> prepare_controller(const ControllerKind& kind,
                                                    const ControllerSpec& controller, const WorldSpec& world,
                                                    const TypeSpec& spec, const BodyType& type,
                                                    std::vector<bool>& claimed);

/// Compiles a body type of a world, in which check_rules() must have found no error. `registry` is the list
/// of all kinds, and must outlive the result. Reports all errors to `diagnostics`, with file positions from
/// the spec. Examples of errors are an unknown kind, and a controller without the sensors that it needs. If
/// there was an error, the result must not be used. Therefore, call Diagnostics::throw_if_errors() before
/// using the result.
BodyType make_body_type(const TypeSpec& spec, const WorldSpec& world, const Registry& registry,
                        Diagnostics& diagnostics);

}  // namespace troupe::engine
