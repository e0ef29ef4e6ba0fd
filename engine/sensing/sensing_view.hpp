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

/// Where the row of a body is, that is, its data in the state tables.
enum class RowLocation : std::uint8_t {
  none,       ///< the body is static: it has no row, and its pose does not change during a run
  here,       ///< in this World
  elsewhere,  ///< in the World of another rank (a thread or process that computes the same world)
};
/// The entry in PublicColumns::rows for a body with RowLocation::elsewhere.
inline constexpr Row k_elsewhere{std::size_t{0xfffffffe}};

/// The number of the present tick, and counts of certain rows, so that loops can skip work when a count is 0.
struct TickCounts {
  /// Number of completed ticks (time steps). Within a step, from the phase `sense` (engine/world/phase.hpp)
  /// on: number of the tick that the step computes.
  std::uint64_t tick = 0;
  std::size_t absent = 0;    ///< rows whose bodies are unborn (not yet in the world) or dead
  std::size_t impaired = 0;  ///< rows whose bodies are disabled or have a fault
  std::size_t carried = 0;   ///< rows whose bodies are carried
};

/// The data of a world that devices may read: the constants, and the *public columns* of the rows. All other
/// data of a row (readings, memories, odometry) are private: only the engine, and the devices and
/// controllers of the row's own body, read them. The state table of a device is public if another kind reads
/// it (DeviceKind::reads), as light sensors read the state of lights.
///
/// A row is the index of a body in the state tables; static bodies, which do not move during a run, have
/// none. A device is a sensor or other equipment of a body, and its kind is the table of functions that
/// implements it. A joint is a movable mount for parts of a body; it is at rest in the pose that the body
/// type defines. The spans have one element per row unless stated otherwise, and stay valid until the number
/// of rows changes (World::remove_rows(), World::add_rows()).
struct PublicColumns {
  // Constants.
  const WorldSpec* spec = nullptr;                    ///< the spec of the world
  const partition::StaticScene* scene = nullptr;      ///< geometry of the static bodies
  const FixedTargets* fixed_targets = nullptr;        ///< parts of static bodies that fiducial finders detect
  const partition::GridGeometry* geometry = nullptr;  ///< sizes of the cells and tiles of `index`
  std::span<const BodyType> types;                    ///< compiled types, indexed by TypeId
  std::span<const BodyId> bodies;                     ///< body of each row
  /// Row of each body, by BodyId: not valid() if the body is static, k_elsewhere if its row is in the world
  /// of another rank.
  std::span<const Row> rows;
  std::span<const std::uint32_t> row_types;     ///< TypeId of each row
  std::span<const std::uint32_t> slots;         ///< index of each row among the rows of its type
  std::span<const std::size_t> outline_begins;  ///< index of the row's first vertex in `outlines`
  std::span<const std::uint32_t> joint_begins;  ///< index of the row's first joint in `joint_mounts`

  // Where the bodies are: written in the phases `intervene`, `move` and `index`.
  const partition::BodyIndex* index = nullptr;   ///< spatial index of the bodies with rows
  const partition::RayGrid* ray_grid = nullptr;  ///< cells of the grid ray engine; null: exact engine
  std::span<const Pose> poses;                   ///< pose of each row, world frame
  std::span<const Transform> transforms;         ///< `poses` as transforms
  std::span<const Vec2> outlines;                ///< vertices of the outlines of all rows, world frame, m
  std::span<const double> radii;  ///< bounding radius about a body's origin, m; negative: unborn or dead
  /// For all joints of all rows: the transform that takes a point on the joint from its place with all joints
  /// at rest to its present place; body frame.
  std::span<const Mount> joint_mounts;
  /// One entry per row: the row of the body that carries the row's body, directly or through others, and is
  /// not carried itself; the row itself if its body is not carried. Empty if no body of the world has joints
  /// or can carry another.
  std::span<const std::uint32_t> roots;
  std::span<const Carried> carriers;  ///< state table `carrier`; empty: no body can carry another
  std::span<const Life> lives;        ///< state table `life`; empty: no births and deaths

  // What the bodies do and show: committed at the end of a tick, but written again in `actuate` or `decide`.
  std::span<const Velocity> velocities;  ///< velocities of the drives, body frame, m/s and rad/s
  std::span<const Command> commands;     ///< commands to the drives
  /// State table `condition`: faults and disabled bodies; empty: the world can have neither
  /// (World::has_conditions() is false).
  std::span<const Condition> conditions;
  std::span<const StateTable> tables;  ///< all state tables, those of devices included
  /// 1 if World::subscribe() was called for the body, so that all its sensors run; otherwise 0.
  std::span<const std::uint8_t> subscribed;

  const TickCounts* now = nullptr;  ///< the tick, and counts of rows
};

/// What a device reads of the world in the phases `sense` (sensors run) and `actuate` (drives and other
/// devices run) of a tick: the constants, and where all bodies are before they move in this tick. The
/// functions only read memory. They make no virtual calls and allocate nothing.
///
/// This class does not give access to the velocities, commands and device states of other bodies, because
/// these change during `actuate`. In `sense`, CommittedView gives access to them. The functions of a device
/// get a DeviceBatch, which gives access to these data for the device's own body.
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
  /// Number of rows in this world. Each body that has a drive, a device or a controller, or that can be
  /// gripped or pushed, has a row. If several ranks (threads or processes) compute the world, some rows may
  /// be on other ranks; they do not count.
  std::size_t rows() const { return columns_.bodies.size(); }
  BodyId body(Row row) const { return columns_.bodies[row.index()]; }  ///< body of a row
  /// Where the row of a body is. The result is RowLocation::none for an id that no body of the world has.
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
  /// Slot of a row: its position among the rows of its type, and so its index in the tables of that type.
  std::size_t slot(Row row) const { return columns_.slots[row.index()]; }

  // ---- time
  /// Number of the present tick; the first tick is 1. Between two steps, and in the phase `intervene`: number
  /// of completed ticks.
  std::uint64_t tick() const { return columns_.now->tick; }
  double tick_s() const { return columns_.spec->tick_s; }  ///< length of a tick, s
  /// World time, s: tick() * tick_s(). In the phases in which devices run, this is the time at the end of the
  /// present tick.
  double time_s() const { return static_cast<double>(tick()) * tick_s(); }
  /// Number of ticks that were completed when the body was born; 0 if it was present at tick 0 or is unborn.
  /// The periods of its devices, drive and controllers count from that tick.
  std::uint64_t birth_tick(Row row) const {
    return columns_.lives.empty() ? 0 : columns_.lives[row.index()].birth;
  }

  // ---- where bodies are
  /// Spatial index of the bodies in the world that have rows.
  const partition::BodyIndex& index() const { return *columns_.index; }
  /// Cells through which the grid ray engine traces rays (RangingEngine::grid). Null if the world uses the
  /// exact ray engine.
  const partition::RayGrid* ray_grid() const { return columns_.ray_grid; }
  /// Whether the row's body is in the world, unborn (not yet in the world) or dead.
  Presence presence(Row row) const {
    return columns_.lives.empty() ? Presence::there
                                  : static_cast<Presence>(columns_.lives[row.index()].presence);
  }
  /// Whether the row's body is in the world. The spatial index contains only such bodies.
  bool is_there(Row row) const { return columns_.now->absent == 0 || presence(row) == Presence::there; }
  /// Pose of each row, m and rad, world frame. All values of an unborn body are 0; a dead body has the last
  /// pose before its death.
  std::span<const Pose> poses() const { return columns_.poses; }
  /// Pose of any body, world frame. The pose of a static body is that of its spec, and the pose of a dead
  /// body is the last one before its death. For an unborn body all values are NaN, unlike in poses(), where
  /// they are 0. Throws std::logic_error if location() is RowLocation::elsewhere.
  Pose pose(BodyId body) const;
  /// The row's pose as a transform. Equals Transform(pose) bit for bit.
  const Transform& transform(Row row) const { return columns_.transforms[row.index()]; }
  /// Vertices of the outlines of a row's body at their present places, m, world frame, in the order of
  /// BodyType::outline_vertices. The body must be in the world.
  std::span<const Vec2> outline(Row row) const {
    return {columns_.outlines.data() + columns_.outline_begins[row.index()],
            type(row).outline_vertices.size()};
  }
  /// Upper bound on the distance of any point of the row's body from its origin, with its joints where they
  /// are now, m. For a body that carries others and is not carried itself, it includes the obstacle shapes of
  /// the carried bodies. Negative if the body is not in the world.
  double radius(Row row) const { return columns_.radii[row.index()]; }
  /// Transform from the body frame to the world frame for the parts and devices on a joint of the row's
  /// body: the row's pose, combined with the present displacement of the joint from rest; for k_rigid, the
  /// row's pose. If a part on the joint has the pose p in the body frame while the joint is at rest,
  /// compose(mount(row, joint), p) is its present pose in the world frame. `joint` is an index into
  /// BodyType::joints or k_rigid.
  Mount mount(Row row, std::int32_t joint) const {
    const Pose& pose = columns_.poses[row.index()];
    const Mount body(transform(row), pose.z, pose.heading);
    return joint == k_rigid ? body : compose(body, joint_mount(row, joint));
  }
  /// Height by which a joint of the row's body and the joints that carry it have raised the parts on the
  /// joint above their rest position, m; 0 for k_rigid. `joint` is as in mount().
  double lift(Row row, std::int32_t joint) const {
    return joint == k_rigid ? 0.0 : joint_mount(row, joint).z;
  }
  /// The body that carries the row's body; std::nullopt if it is not carried.
  std::optional<BodyId> carrier(Row row) const {
    const std::uint32_t id = columns_.carriers.empty() ? 0 : columns_.carriers[row.index()].carrier;
    return id == 0 ? std::optional<BodyId>() : BodyId(id - 1);
  }
  /// Whether two bodies move together: one carries the other, directly or through further bodies, or a third
  /// body carries both. True if a and b are the same row.
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

/// A SensingView that also gives access to the velocities, commands and device states of all bodies. Devices
/// receive it in the phase `sense` (SenseBatch). In that phase, the data are those of the end of the last
/// tick, as changed by interventions. Functions that run between two phases get the view from World::view().
/// In the phase `sense`, a device must not read the state of sensors, because other threads are writing it.
class CommittedView : public SensingView {
 public:
  using SensingView::SensingView;

  /// State of a device (an element of BodyType::devices): a table with one row per slot of the body type.
  using SensingView::percepts;
  /// Commands to a device: a table with one row per slot of the body type. The device must take commands.
  using SensingView::commands;
  /// Velocity that the drive of the row's body computed, body frame, m/s and rad/s. It is 0 if the body has
  /// no drive. From the next tick on, it is also 0 while the body is disabled or dropped out by a fault, or
  /// while the power supply of its drive is empty. It does not become 0 when an obstacle blocks the motion.
  using SensingView::velocity;
  /// Command to the drive of the row's body. The numbers have no meaning for rows without a drive.
  using SensingView::command;
  /// Whether a sensor of the row is active (a controller uses it, or the world file makes it active:
  /// BodyType::Device::active), or World::subscribe() was called for its body.
  using SensingView::senses;
  /// Whether the row's device is switched on: no controller has switched it off.
  using SensingView::is_on;
  /// Whether no fault has broken the row's device, and its body is neither disabled nor dropped out by a
  /// fault.
  using SensingView::works;
  /// Whether a device of the row gets power: false if its power supply is empty. The second argument is the
  /// index of that supply among the devices of the type (BodyType::Device::supply). If it is std::nullopt,
  /// the device has no supply and the result is true.
  using SensingView::is_supplied;
  /// Whether the row's device runs in the ticks in which it is due, that is, once per
  /// BodyType::Device::period. The device runs if senses(), is_on(), works() and is_supplied() are true for
  /// it.
  using SensingView::runs;
};

}  // namespace troupe::engine
