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

/// A closed outline that rays may meet: vertices [first, first + count) of the type.
struct RayOutline {
  std::uint32_t first = 0;  ///< index of its first vertex in BodyType::outline_vertices
  std::uint32_t count = 0;  ///< vertices, at least one
  ZInterval z;              ///< body frame
  /// Intensity that rangers read, Returns::ranger; below 0 of outlines that they pass.
  float ranger_return = 1;
  std::uint32_t part = 0;        ///< that it is of
  std::uint32_t solid = 0;       ///< of the type: contours of one number are one even-odd region
  std::int32_t joint = k_rigid;  ///< of the type, that it moves with
};

/// A TypeSpec made ready to run: what identical bodies share and never changes during a run.
struct BodyType {
  std::string name;                           ///< TypeSpec::name
  partition::ObstacleShape obstacle;          ///< with every joint at rest
  std::vector<std::int32_t> obstacle_joints;  ///< of its pieces; empty where the type has no joints
  partition::ObstacleShape grip;              ///< what grippers feel; empty where they cannot take it
  std::vector<Vec2> outline_vertices;         ///< body frame
  std::vector<RayOutline> outlines;           ///< that rangers see; their vertices come first
  std::vector<RayOutline> hidden_outlines;    ///< that rangers do not: fiducial finders and others do
  /// Of the circle about the origin that encloses every outline, obstacle and target of fiducial finders, m.
  double radius = 0;                   ///< with every joint at rest
  double joint_reach = 0;              ///< by how much joints are known to widen it, m
  std::vector<std::uint32_t> targets;  ///< parts that fiducial finders find

  /// A JointSpec made ready to run.
  struct Joint {
    std::string name;       ///< of its component, `joint/<name>`
    std::int32_t parent;    ///< index of the joint that it stands on, which comes before it; k_rigid: none
    Mount at_rest;          ///< in the body's frame, as is
    Mount to_body;          ///< its inverse
    std::size_t table = 0;  ///< where it is: index into World::tables()
  };
  std::vector<Joint> joints;  ///< in the order of TypeSpec::joints

  /// A DriveSpec made ready to run.
  struct Drive {
    const DriveKind* kind;                                     ///< in the registry
    std::any data;                                             ///< what the kind prepared
    std::uint64_t period;                                      ///< ticks
    Localization localization;                                 ///< how its robots know where they are
    std::optional<std::size_t> odometry_table = std::nullopt;  ///< index into World::tables()
    std::optional<std::size_t> supply = std::nullopt;          ///< what it runs on: index into `devices`
    std::uint8_t pushes = 0;                                   ///< how many bodies it pushes at once
  };
  std::optional<Drive> drive;  ///< none: bodies of the type do not move by themselves
  bool pushable = false;       ///< robots push it; it has no drive

  /// A DeviceSpec made ready to run.
  struct Device {
    std::string name;                          ///< DeviceSpec::name
    const DeviceKind* kind;                    ///< in the registry
    DeviceKind::Prepared prepared;             ///< what the kind prepared from its parameters
    std::uint64_t period;                      ///< ticks
    bool active;                               ///< runs: always on, or a controller reads it
    std::uint32_t part;                        ///< that carries it
    std::int32_t joint;                        ///< of the type, that it stands on
    std::int32_t moves;                        ///< first of the joints that it moves
    std::uint32_t stream;                      ///< of its random numbers
    std::optional<std::size_t> supply;         ///< what it runs on: index into `devices`
    std::size_t table = 0;                     ///< its percepts: index into World::tables()
    std::optional<std::size_t> command_table;  ///< what is asked of it: index into World::tables()
    std::uint32_t switch_bit = 0;              ///< in Command::off; 0: no controller switches it
  };
  std::vector<Device> devices;  ///< in the order of TypeSpec::devices
  std::vector<std::size_t>
      joint_devices;     ///< those that move joints: the devices that stand on them come later
  bool carries = false;  ///< a device can pick up other bodies

  /// A ControllerSpec made ready to run.
  struct Controller {
    const ControllerKind* kind;        ///< in the registry
    std::any data;                     ///< what the kind prepared from its parameters
    std::vector<std::size_t> devices;  ///< indices into `devices`; the first is the trigger
    std::uint64_t period;              ///< ticks
    std::uint32_t stream;              ///< of its random numbers
    std::optional<std::size_t> table;  ///< its memories: index into World::tables()
    std::optional<std::size_t> drive;  ///< that it commands: index into `devices`; none: the body's
  };
  std::vector<Controller> controllers;  ///< in the order of TypeSpec::controllers

  /// What a body of this type takes: readings, memories and its outline.
  double row_bytes() const;
  /// Whether bodies of the type have a row: they can move, be moved, sense or decide.
  bool runs() const { return drive || !devices.empty() || !controllers.empty() || !grip.empty() || pushable; }
  /// Whether their obstacle shape changes.
  bool is_composite() const { return !joints.empty() || carries; }
};

/// What a device's memory grows with, known before any is taken: the sum of its parameters that count
/// readings (Field::counts_readings), also in lists of blocks.
double samples_asked_for(const FieldTable& table, const Record& params);

/// Makes a device of a type; or says what is wrong with it, also where its kind throws.
Result<DeviceKind::Prepared> prepare_device(const DeviceKind& kind, const DeviceSpec& device,
                                            const WorldSpec& world, const TypeSpec& spec);

/// Makes a controller for a type whose devices are made. It is shown those below its part only, and chooses
/// among them; or says why it cannot have what it needs, also where its kind throws.
Result<ControllerKind::Prepared> prepare_controller(const ControllerKind& kind,
                                                    const ControllerSpec& controller, const WorldSpec& world,
                                                    const TypeSpec& spec, const BodyType& type,
                                                    std::vector<bool>& claimed);

/// Reports what cannot be built (unknown kinds, controllers without their sensors) at the spec's places.
BodyType make_body_type(const TypeSpec& spec, const WorldSpec& world, const Registry& registry,
                        Diagnostics& diagnostics);

}  // namespace troupe::engine
