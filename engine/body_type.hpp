#pragma once

#include "engine/kinds.hpp"
#include "engine/mount.hpp"
#include "engine/world_spec.hpp"
#include "partition/overlap.hpp"

#include <any>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::engine {

/// A closed outline that rays may hit: the vertices [first, first + count) of BodyType::outline_vertices.
struct RayOutline {
  std::uint32_t first = 0;  ///< index of its first vertex in BodyType::outline_vertices
  std::uint32_t count = 0;  ///< number of its vertices, at least one
  ZInterval z;              ///< height interval, body frame
  /// Intensity that rangers read (Returns::ranger); negative if their beams pass through the outline.
  float ranger_return = 1;
  std::uint32_t part = 0;   ///< index of its part in the type
  std::uint32_t solid = 0;  ///< number of its solid; the outlines of a solid bound one region (even-odd rule)
  std::int32_t joint = k_rigid;  ///< index of the joint that moves it; k_rigid: none
};

/// A compiled TypeSpec: the data that bodies of one type share. It is constant during a run, except for
/// parameters that an intervention changes (SettingSpec).
struct BodyType {
  std::string name;                   ///< name of the type (TypeSpec::name)
  partition::ObstacleShape obstacle;  ///< obstacle shape with every joint at rest, body frame
  /// For each piece of `obstacle`, the index of the joint that it is mounted on. Empty if the type has no
  /// joints.
  std::vector<std::int32_t> obstacle_joints;
  partition::ObstacleShape grip;       ///< shape that grippers detect; empty if they cannot grip the body
  std::vector<Vec2> outline_vertices;  ///< vertices of all outlines, body frame, m
  std::vector<RayOutline> outlines;    ///< outlines that rangers see; their vertices come first
  std::vector<RayOutline> hidden_outlines;  ///< outlines that only sensors other than rangers see
  /// Radius of the circle about the body's origin that encloses every outline, obstacle and fiducial target
  /// with every joint at rest, m.
  double radius = 0;
  double joint_reach = 0;              ///< largest distance by which the joints can extend `radius`, m
  std::vector<std::uint32_t> targets;  ///< indices of the parts that fiducial finders detect

  /// A joint of the type, compiled from its JointSpec.
  struct Joint {
    std::string name;       ///< name; the joint's state is the component `joint/<name>`
    std::int32_t parent;    ///< index of its parent joint, which precedes it; k_rigid: none
    Mount at_rest;          ///< frame of the joint at rest, in the body frame
    Mount to_body;          ///< inverse of `at_rest`
    std::size_t table = 0;  ///< table of the joint's poses: index into World::tables()
  };
  std::vector<Joint> joints;  ///< joints of the type, in the order of TypeSpec::joints

  /// The drive of the type, compiled from its DriveSpec.
  struct Drive {
    const DriveKind* kind;                                     ///< its kind, owned by the registry
    std::any data;                                             ///< result of DriveKind::prepare
    std::uint64_t period;                                      ///< ticks from one run to the next
    Localization localization;                                 ///< how its robots estimate their poses
    std::optional<std::size_t> odometry_table = std::nullopt;  ///< odometry: index into World::tables()
    std::optional<std::size_t> supply = std::nullopt;          ///< its power supply: index into `devices`
    std::uint8_t pushes = 0;  ///< largest number of bodies that it can push at once
  };
  std::optional<Drive> drive;  ///< none: bodies of the type do not move on their own
  bool pushable = false;       ///< true: robots can push bodies of this type, which then has no drive

  /// A sensor or another device of the type, compiled from its DeviceSpec.
  struct Device {
    std::string name;               ///< name of the device (DeviceSpec::name)
    const DeviceKind* kind;         ///< its kind, owned by the registry
    DeviceKind::Prepared prepared;  ///< result of DeviceKind::prepare
    std::uint64_t period;           ///< ticks from one run to the next
    bool active;           ///< it runs without a subscription: DeviceSpec::active, or a controller uses it
    std::uint32_t part;    ///< part that carries it: index in the type
    std::int32_t joint;    ///< joint that it is mounted on: index in the type; k_rigid: none
    std::int32_t moves;    ///< first of the joints that it moves: index in the type; k_rigid: none
    std::uint32_t stream;  ///< stream of its random numbers
    std::optional<std::size_t> supply;         ///< its power supply: index into `devices`
    std::size_t table = 0;                     ///< table of its percepts: index into World::tables()
    std::optional<std::size_t> command_table;  ///< table of its commands: index into World::tables()
    std::uint32_t switch_bit = 0;              ///< its bit in Command::off; 0: no controller switches it

    /// Whether it measures ranges: its first percept then holds one range per beam, m, as float32.
    bool is_ranger() const { return !prepared.bearings.empty(); }
  };
  std::vector<Device> devices;  ///< sensors and other devices, in the order of TypeSpec::devices
  /// Indices of the devices that move joints. Each comes before the devices that are mounted on its joints.
  std::vector<std::size_t> joint_devices;
  bool carries = false;  ///< whether a device of the type can pick up other bodies

  /// A controller of the type, compiled from its ControllerSpec.
  struct Controller {
    const ControllerKind* kind;  ///< its kind, owned by the registry
    std::any data;               ///< result of ControllerKind::prepare
    /// The devices that it uses: indices into BodyType::devices. It runs when the first of them runs.
    std::vector<std::size_t> devices;
    std::uint64_t period;              ///< ticks from one run to the next
    std::uint32_t stream;              ///< stream of its random numbers
    std::optional<std::size_t> table;  ///< table of its memories: index into World::tables()
    /// The drive device that it commands: index into BodyType::devices. Not set: it commands the drive of the
    /// body.
    std::optional<std::size_t> drive;
  };
  std::vector<Controller> controllers;  ///< in the order in which they decide (TypeSpec::controllers)

  /// Estimated memory that each body takes, bytes: for its outlines, joints, readings, device commands and
  /// controller memories.
  double row_bytes() const;
  /// Whether bodies of the type have a row in the state tables. They have one if they can move, sense,
  /// decide, be gripped or be pushed.
  bool runs() const { return drive || !devices.empty() || !controllers.empty() || !grip.empty() || pushable; }
  /// Whether the obstacle shape of a body can change. It can if the body has joints or can carry other
  /// bodies.
  bool is_composite() const { return !joints.empty() || carries; }
};

/// The number of readings that a device with these parameters has: the sum of the parameters that count
/// readings (Field::counts_readings), including those in lists of parameter blocks. Callers compare this
/// number with a limit before they prepare the device, which allocates memory for the readings.
double samples_asked_for(const FieldTable& table, const Record& params);

/// Calls the hooks of a device kind that compile a device: prepare, bind_part, bind_world and reach_m. `spec`
/// is the type that has the device. Returns the compiled device. The error says what is wrong with the
/// device, or which exception its kind threw.
Result<DeviceKind::Prepared> prepare_device(const DeviceKind& kind, const DeviceSpec& device,
                                            const WorldSpec& world, const TypeSpec& spec);

/// Compiles a controller of a type. `spec` is the type, and `type` is the same type with compiled devices.
/// The controller chooses among the devices of its part and of the parts mounted on that part, except drives.
/// It sets claimed[d] for each device d of the type that it reserves for itself. The error says what the
/// controller lacks, or which exception its kind threw.
Result<ControllerKind::Prepared> prepare_controller(const ControllerKind& kind,
                                                    const ControllerSpec& controller, const WorldSpec& world,
                                                    const TypeSpec& spec, const BodyType& type,
                                                    std::vector<bool>& claimed);

/// Compiles a type of a world. Reports errors (unknown kinds, controllers without the sensors that they need)
/// to `diagnostics`, at the file positions that the spec gives.
BodyType make_body_type(const TypeSpec& spec, const WorldSpec& world, const Registry& registry,
                        Diagnostics& diagnostics);

}  // namespace troupe::engine
