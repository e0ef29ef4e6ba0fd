#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/commands.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/mount.hpp"
#include "engine/sensing/fixed_targets.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/body_index.hpp"
#include "partition/ray_grid.hpp"
#include "partition/static_scene.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::engine {

/// Where the row of a body is. The row is the entry of the body in the state tables.
enum class RowLocation : std::uint8_t {
  none,       ///< the body is static: it has no row, and its pose does not change during a run
  here,       ///< in this World
  elsewhere,  ///< in the World of another rank (a thread or process that computes the same world)
};
/// Value in PublicColumns::rows for a body whose row is in the World of another rank
/// (RowLocation::elsewhere).
inline constexpr Row k_elsewhere{std::size_t{0xfffffffe}};

/// Values of the component `stall`: the outcome of the last motion.
enum class Stall : std::uint8_t {
  free,           ///< the motion was carried out, or there was none
  blocked,        ///< another body, mobile or static, was in the way
  out_of_bounds,  ///< the motion would have ended outside the bounds of the world
};

/// The tick number, and how many rows are in certain conditions. While such a count is 0, loops need not test
/// each row for the condition.
struct TickCounts {
  /// Number of completed ticks (time steps). In the phase `sense` and the later phases of a step
  /// (engine/state/phase.hpp), the tick that is being computed is already counted.
  std::uint64_t tick = 0;
  std::size_t absent = 0;    ///< rows whose bodies are unborn (not yet in the world) or dead
  std::size_t impaired = 0;  ///< rows whose bodies are disabled or have a fault
  std::size_t carried = 0;   ///< rows whose bodies are carried
  /// Own rows whose body's last motion was blocked or out of bounds.
  std::size_t stalled = 0;
  std::size_t out_of_bounds = 0;  ///< rows of `stalled` whose body's last motion was out of bounds
};

/// The data of a world that devices may read: constants, such as the spec of the world, and *public columns*,
/// which are data of all bodies, such as their poses. Other data of a body (readings, memories, odometry) are
/// private: only the engine and the body's own devices and controllers read them. If a kind of device
/// declares that it reads the states of another kind (DeviceKind::reads), these states are public too. For
/// example, light sensors read the states of lights.
///
/// A *row* is the index of a body in the state tables. Static bodies, which do not move during a run, have no
/// row. A *rank* is a thread or process that computes the world together with other ranks, each with a World
/// of its own. A *device* is a sensor or other equipment of a body. A *kind* is the table of functions that
/// implements devices. A *joint* is a movable mount for parts of a body; it is *at rest* in the pose that the
/// body type defines.
///
/// The spans have one element per row unless stated otherwise. They stay valid until the number of rows
/// changes (World::remove_rows(), World::add_rows()).
struct PublicColumns {
  // Constants.
  const WorldSpec* spec = nullptr;                    ///< the spec of the world
  const partition::StaticScene* scene = nullptr;      ///< geometry of the static bodies
  const FixedTargets* fixed_targets = nullptr;        ///< parts of static bodies that fiducial finders detect
  const partition::GridGeometry* geometry = nullptr;  ///< sizes of the cells and tiles of `index`
  std::span<const BodyType> types;                    ///< compiled types, indexed by TypeId
  std::span<const BodyId> bodies;                     ///< body of each row
  /// Row of each body, indexed by BodyId. Not valid() if the body is static; k_elsewhere if the row is in the
  /// World of another rank.
  std::span<const Row> rows;
  std::span<const std::uint32_t> row_types;     ///< TypeId of each row
  std::span<const std::uint32_t> slots;         ///< index of each row among the rows of its type
  std::span<const std::size_t> outline_begins;  ///< index of the row's first vertex in `outlines`
  /// Index of the row's first joint in `joint_mounts`. Empty if no body of the world has joints or can carry
  /// another.
  std::span<const std::uint32_t> joint_begins;

  // Where the bodies are: written in the phases `intervene`, `move` and `index`.
  const partition::BodyIndex* index = nullptr;   ///< spatial index of the bodies with rows
  const partition::RayGrid* ray_grid = nullptr;  ///< cells of the grid ray engine; null: exact engine
  std::span<const Pose> poses;                   ///< pose of each row, world frame
  std::span<const Transform> transforms;         ///< `poses` as transforms
  std::span<const Vec2> outlines;                ///< vertices of the outlines of all rows, world frame, m
  std::span<const double> radii;  ///< bounding radius about a body's origin, m; negative: unborn or dead
  /// The displacements of joints from rest: one entry per joint of each row, from the index joint_begins[row]
  /// on. Take a point that is fixed to the joint, and that is at p in the body frame while all joints are at
  /// rest. The entry transforms p into the present position of the point in the body frame.
  std::span<const Mount> joint_mounts;
  /// The root of each row, as a row. A body that is not carried is its own root. The root of a carried body
  /// is the body that carries it, directly or through others, and is itself not carried. Empty if no body of
  /// the world has joints or can carry another.
  std::span<const std::uint32_t> roots;
  std::span<const Carried> carriers;     ///< state table `carrier`; empty: no body can carry another
  std::span<const Life> lives;           ///< state table `life`; empty: no births and deaths
  std::span<const std::uint8_t> stalls;  ///< state table `stall`: values of Stall
  /// What blocked each body in the last tick; empty: unknown.
  std::span<const Contact> contacts;

  // What the bodies do and show: committed at the end of a tick, but written again in `actuate` or `decide`.
  std::span<const Velocity> velocities;  ///< velocities of the drives, body frame, m/s and rad/s
  std::span<const Command> commands;     ///< commands to the drives
  /// State table `condition`: which bodies are disabled, and which faults they have. Empty if no body of the
  /// world can be disabled or have faults (CommittedView::has_conditions() is false).
  std::span<const Condition> conditions;
  std::span<const StateTable> tables;  ///< all state tables, those of devices included
  /// 1 if World::subscribe() was called for the row's body, so that all its sensors run; otherwise 0.
  std::span<const std::uint8_t> subscribed;

  const TickCounts* now = nullptr;  ///< the tick, and counts of rows
};

}  // namespace troupe::engine
