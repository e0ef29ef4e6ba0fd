#pragma once

#include "engine/fields/state_table.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/kinds/mount.hpp"
#include "engine/sensing/fixed_targets.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/body_index.hpp"
#include "partition/ray_grid.hpp"
#include "partition/static_scene.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
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

/// The tick number, and how many rows are in certain conditions. While such a count is 0, loops need not test
/// each row for the condition.
struct TickCounts {
  /// Number of completed ticks (time steps). In the phase `sense` and the later phases of a step
  /// (engine/world/phase.hpp), the tick that is being computed is already counted.
  std::uint64_t tick = 0;
  std::size_t absent = 0;    ///< rows whose bodies are unborn (not yet in the world) or dead
  std::size_t impaired = 0;  ///< rows whose bodies are disabled or have a fault
  std::size_t carried = 0;   ///< rows whose bodies are carried
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
  std::span<const Carried> carriers;  ///< state table `carrier`; empty: no body can carry another
  std::span<const Life> lives;        ///< state table `life`; empty: no births and deaths

  // What the bodies do and show: committed at the end of a tick, but written again in `actuate` or `decide`.
  std::span<const Velocity> velocities;  ///< velocities of the drives, body frame, m/s and rad/s
  std::span<const Command> commands;     ///< commands to the drives
  /// State table `condition`: which bodies are disabled, and which faults they have. Empty if no body of the
  /// world can be disabled or have faults (World::has_conditions() is false).
  std::span<const Condition> conditions;
  std::span<const StateTable> tables;  ///< all state tables, those of devices included
  /// 1 if World::subscribe() was called for the row's body, so that all its sensors run; otherwise 0.
  std::span<const std::uint8_t> subscribed;

  const TickCounts* now = nullptr;  ///< the tick, and counts of rows
};

/// What a device reads of the world in two phases of a tick: in `sense`, in which sensors run, and in
/// `actuate`, in which drives and other devices run. The view shows constants, such as the spec of the world,
/// and where all bodies are before they move in this tick. The functions only read memory. They make no
/// virtual calls and allocate nothing.
///
/// The view does not show the velocities, commands and device states of bodies, because these data change
/// during `actuate`. A device gets those of its own body from its DeviceBatch. In `sense`, a device also gets
/// a CommittedView, which shows those of all bodies.
class SensingView {
 public:
  SensingView() = default;  ///< a view without a world; no function may be called
  explicit SensingView(const PublicColumns& columns) : columns_(columns) {}  ///< a view of a world

  // ---- constants
  const WorldSpec& spec() const { return *columns_.spec; }            ///< the spec of the world
  std::span<const BodyType> types() const { return columns_.types; }  ///< compiled types, indexed by TypeId
  const partition::StaticScene& scene() const { return *columns_.scene; }  ///< geometry of the static bodies
  /// Spatial index of the parts of static bodies that fiducial finders (sensors for marked parts) detect.
  const FixedTargets& fixed_targets() const { return *columns_.fixed_targets; }
  /// Sizes of the cells and tiles of the spatial index. No result depends on them.
  const partition::GridGeometry& geometry() const { return *columns_.geometry; }
  /// Number of rows in this World. Each body that has a drive, a device or a controller, or that can be
  /// gripped or pushed, has a row. Rows in the Worlds of other ranks (RowLocation::elsewhere) do not count.
  std::size_t rows() const { return columns_.bodies.size(); }
  BodyId body(Row row) const { return columns_.bodies[row.index()]; }  ///< body of a row
  /// Where the row of a body is. The result is RowLocation::none also for an id that no body of the world
  /// has.
  RowLocation location(BodyId body) const {
    if (body.index() >= columns_.rows.size()) return RowLocation::none;
    const Row row = columns_.rows[body.index()];
    return row == k_elsewhere ? RowLocation::elsewhere : row.valid() ? RowLocation::here : RowLocation::none;
  }
  /// Row of a body of the world. Static bodies have no row: for a static body the result is not valid().
  /// Throws std::logic_error if location() is RowLocation::elsewhere.
  Row row(BodyId body) const {
    const Row row = columns_.rows[body.index()];
    if (row == k_elsewhere) throw_elsewhere(body);
    return row;
  }
  /// Type of the row's body.
  const BodyType& type(Row row) const { return columns_.types[columns_.row_types[row.index()]]; }
  /// Slot of a row: its index among the rows of its type. The tables of the type are indexed by slots.
  std::size_t slot(Row row) const { return columns_.slots[row.index()]; }

  // ---- time
  /// In the phase `sense` and the later phases of a step: number of the tick that is being computed; the
  /// first tick is 1. Between two steps, and in the phase `intervene`: number of completed ticks.
  std::uint64_t tick() const { return columns_.now->tick; }
  double tick_s() const { return columns_.spec->tick_s; }  ///< length of a tick, s
  /// Simulated time, s: tick() * tick_s(). While devices run, it is the time at the end of the tick that is
  /// being computed.
  double time_s() const { return static_cast<double>(tick()) * tick_s(); }
  /// Number of ticks that were completed when the row's body was born; 0 if the body was present at tick 0
  /// (the initial state) or is unborn. The periods of the devices, the drive and the controllers of the body
  /// are counted from this tick.
  std::uint64_t birth_tick(Row row) const {
    return columns_.lives.empty() ? 0 : columns_.lives[row.index()].birth;
  }

  // ---- where bodies are
  /// Spatial index of all bodies that have rows and are in the world.
  const partition::BodyIndex& index() const { return *columns_.index; }
  /// The grid of cells through which rays are traced if the world computes ranges with RangingEngine::grid.
  /// Null if it uses RangingEngine::exact.
  const partition::RayGrid* ray_grid() const { return columns_.ray_grid; }
  /// Whether the row's body is in the world, unborn (not yet in the world) or dead.
  Presence presence(Row row) const {
    return columns_.lives.empty() ? Presence::there
                                  : static_cast<Presence>(columns_.lives[row.index()].presence);
  }
  /// Whether the row's body is in the world. The spatial index contains only such bodies.
  bool is_there(Row row) const { return columns_.now->absent == 0 || presence(row) == Presence::there; }
  /// Pose of each row, m and rad, world frame. For a dead body, the last pose before its death. For an unborn
  /// body, all values are 0.
  std::span<const Pose> poses() const { return columns_.poses; }
  /// Pose of any body, m and rad, world frame. For a static body, the pose in the spec. For a dead body, the
  /// last pose before its death. For an unborn body, all values are NaN, whereas they are 0 in poses().
  /// Throws std::logic_error if location() is RowLocation::elsewhere.
  Pose pose(BodyId body) const;
  /// The row's pose in the world frame, as a transform. Equals Transform(poses()[row.index()]) bit for bit.
  const Transform& transform(Row row) const { return columns_.transforms[row.index()]; }
  /// Vertices of the outlines of a row's body at their present places, m, world frame, in the order of
  /// BodyType::outline_vertices. The body must be in the world.
  std::span<const Vec2> outline(Row row) const {
    return {columns_.outlines.data() + columns_.outline_begins[row.index()],
            type(row).outline_vertices.size()};
  }
  /// Upper bound on the distance from the origin of the row's body to any point of the body, with the joints
  /// where they are now, m. If the body carries others and is not itself carried, the bound also holds for
  /// the obstacle shapes of all bodies that it carries. Negative if the body is not in the world.
  double radius(Row row) const { return columns_.radii[row.index()]; }
  /// Transform that gives the present poses of the parts and devices on a joint of the row's body. Let p be
  /// the pose of such a part in the body frame while all joints are at rest. The present pose of the part in
  /// the world frame is compose(mount(row, joint), p).
  ///
  /// joint: index into BodyType::joints; k_rigid: parts that are on no joint, for which the result is the
  /// pose of the body
  Mount mount(Row row, std::int32_t joint) const {
    const Pose& pose = columns_.poses[row.index()];
    const Mount body(transform(row), pose.z, pose.heading);
    return joint == k_rigid ? body : compose(body, joint_mount(row, joint));
  }
  /// How far the parts on a joint of the row's body are above their height with all joints at rest, m. 0 if
  /// `joint` is k_rigid. `joint` is as in mount().
  double lift(Row row, std::int32_t joint) const {
    return joint == k_rigid ? 0.0 : joint_mount(row, joint).z;
  }
  /// The body that carries the row's body directly; std::nullopt if the row's body is not carried.
  std::optional<BodyId> carrier(Row row) const {
    const std::uint32_t id = columns_.carriers.empty() ? 0 : columns_.carriers[row.index()].carrier;
    return id == 0 ? std::optional<BodyId>() : BodyId(id - 1);
  }
  /// Whether the bodies of two rows move together: one of them carries the other, or a third body carries
  /// both, directly or through further bodies. True if a and b are the same row.
  bool same_tree(Row a, Row b) const {
    return a == b || (columns_.now->carried > 0 && columns_.roots[a.index()] == columns_.roots[b.index()]);
  }

 protected:
  friend struct DeviceBatch;  // gives a device the columns below, but only those of its own body

  [[noreturn]] void throw_elsewhere(BodyId body) const;
  const Mount& joint_mount(Row row, std::int32_t joint) const {
    return columns_.joint_mounts[columns_.joint_begins[row.index()] + static_cast<std::size_t>(joint)];
  }
  const StateTable& percepts(const BodyType::Device& device) const { return columns_.tables[device.table]; }
  const StateTable& commands(const BodyType::Device& device) const {
    return columns_.tables[*device.command_table];
  }
  const Velocity& velocity(Row row) const { return columns_.velocities[row.index()]; }
  const Command& command(Row row) const { return columns_.commands[row.index()]; }
  bool senses(Row row, const BodyType::Device& device) const {
    return device.active || columns_.subscribed[row.index()] != 0;
  }
  bool is_on(Row row, const BodyType::Device& device) const {
    if (device.switch_bit == 0) return true;
    if ((command(row).off & device.switch_bit) != 0) return false;
    // A controller on a part with a drive of its own gives its command to that drive.
    return std::ranges::none_of(type(row).devices, [&](const BodyType::Device& drive) {
      return drive.kind->drives && (commands(drive).as<Command>(slot(row)).off & device.switch_bit) != 0;
    });
  }
  bool works(Row row, const BodyType::Device& device) const {
    if (columns_.now->impaired == 0) return true;
    const Condition& condition = columns_.conditions[row.index()];
    const auto d = static_cast<std::size_t>(&device - type(row).devices.data());
    return condition.out == 0 && (d >= k_most_fallible || (condition.dead >> d & 1) == 0);
  }
  bool is_supplied(Row row, std::optional<std::size_t> supply) const {
    if (!supply) return true;
    const BodyType::Device& device = type(row).devices[*supply];
    return !device.kind->is_spent(device.prepared.data, columns_.tables[device.table], slot(row));
  }
  bool runs(Row row, const BodyType::Device& device) const {
    return senses(row, device) && is_on(row, device) && works(row, device) && is_supplied(row, device.supply);
  }

  PublicColumns columns_;
};

/// A SensingView that also shows the velocities, commands and device states of all bodies. In the phase
/// `sense`, devices get it in a SenseBatch. The data are then those after the last tick, with the changes
/// that interventions have made since. In this phase, a device must not read the states of sensors, because
/// other threads are writing them. Code that runs between two phases gets the view from World::view().
class CommittedView : public SensingView {
 public:
  using SensingView::SensingView;

  /// percepts(device): the state table of a device of a body type (an element of BodyType::devices). The
  /// table has one entry per body of the type, indexed by slot().
  using SensingView::percepts;
  /// commands(device): the table of the commands to a device of a body type. The table has one entry per body
  /// of the type, indexed by slot(). The device must take commands (BodyType::Device::command_table).
  using SensingView::commands;
  /// velocity(row): the last velocity that the drive of the row's body computed, body frame, m/s and rad/s.
  /// It is 0 if the body has no drive. The phase `actuate` sets it to 0 if the body is disabled or stopped by
  /// a fault, or if the power supply of the drive is empty. The velocity does not become 0 when an obstacle
  /// blocks the motion.
  using SensingView::velocity;
  /// command(row): the command to the drive of the row's body. The numbers have no meaning if there is no
  /// drive.
  using SensingView::command;
  /// senses(row, device): whether the row's device is in use. It is if the device is active
  /// (BodyType::Device::active: a controller uses it, or the world file makes it active), or if
  /// World::subscribe() was called for the body.
  using SensingView::senses;
  /// is_on(row, device): false if a controller has switched the row's device off. Otherwise true.
  using SensingView::is_on;
  /// works(row, device): false if a fault has broken the row's device or has stopped its body, or if the body
  /// is disabled. Otherwise true.
  using SensingView::works;
  /// is_supplied(row, supply): false if the power supply with the index `supply` in BodyType::devices is
  /// empty on the row's body. Pass BodyType::Device::supply of a device to learn whether this device gets
  /// power. If `supply` is std::nullopt, the device has no power supply, and the result is true.
  using SensingView::is_supplied;
  /// runs(row, device): whether the row's device runs in the ticks in which it is due. A device is due once
  /// per BodyType::Device::period. It then runs if senses(), is_on(), works() and is_supplied() are all true
  /// for it.
  using SensingView::runs;
};

}  // namespace troupe::engine
