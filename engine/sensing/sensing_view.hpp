#pragma once

#include "engine/sensing/public_columns.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

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
  /// Type of any body, static or not.
  const BodyType& type(BodyId body) const {
    return columns_.types[columns_.spec->bodies[body.index()].type.index()];
  }
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
  /// The row of the root of the tree that contains the row's body; the row itself if its body is not carried.
  Row root(Row row) const { return columns_.now->carried > 0 ? Row(columns_.roots[row.index()]) : row; }

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
  /// All state tables. Members of BodyType such as Device::table are indices into this list.
  std::span<const StateTable> tables() const { return columns_.tables; }
  /// Returns the index of the row's body in a state table: the row itself if the table has entries for bodies
  /// of all types, otherwise the slot. The table must have an entry for the body. If it has none, the result
  /// is meaningless, and may be out of range; find_in() checks this.
  std::size_t row_in(const StateTable& table, Row row) const {
    const std::size_t r = row.index();
    return r < table.rows() && table.ids()[r] == columns_.bodies[r] ? r : columns_.slots[r];
  }
  /// Like row_in(), but returns std::nullopt if the table has no entry for the row's body.
  std::optional<std::size_t> find_in(const StateTable& table, Row row) const {
    const std::size_t at = row_in(table, row);
    if (at < table.rows() && table.ids()[at] == columns_.bodies[row.index()]) return at;
    return std::nullopt;
  }
  /// The counts of certain rows. If the rows are distributed among ranks, call World::gather() before, except
  /// for the tick.
  const TickCounts& counts() const { return *columns_.now; }
  /// Velocity of each row: see velocity().
  std::span<const Velocity> velocities() const { return columns_.velocities; }
  /// Command to the drive of each row: see command().
  std::span<const Command> commands() const { return columns_.commands; }
  /// Number of rows whose bodies are unborn or dead.
  std::size_t absent_count() const { return columns_.now->absent; }
  /// Whether the state has the component `life`, because bodies can be born or die.
  bool has_lives() const { return !columns_.lives.empty(); }
  /// Estimated poses of all bodies of a type, each in the frame that the Localization of its drive defines.
  /// By default, the estimate is the true pose in the world frame. With odometry, its frame is by default the
  /// robot's pose at tick 0 or at its birth. For a type without a drive: the true poses, world frame. The
  /// result is valid as long as the view.
  Estimates estimates(const BodyType& type) const;
  /// Estimated pose of the row's body, m and rad, in the frame of estimates().
  Pose estimate(Row row) const { return estimates(type(row)).of(row, slot(row)); }
  /// The outcome of the last motion of the row's body. Stall::free before the first tick, and after
  /// World::set_poses() has placed the body.
  Stall stall(Row row) const { return static_cast<Stall>(columns_.stalls[row.index()]); }
  /// Whether the row's last motion was blocked or out of bounds.
  bool stalled(Row row) const { return stall(row) != Stall::free; }
  bool is_out_of_bounds(Row row) const { return stall(row) == Stall::out_of_bounds; }  ///< see stall()
  /// What blocked the row's body in the last tick. Known only if the state has the component `contact`
  /// (WorldSpec::contacts), or in ticks that begin after a call of World::watch_contacts(); otherwise all
  /// members are zero, as for a body that nothing blocked.
  Contact contact(Row row) const {
    return columns_.contacts.empty() ? Contact() : columns_.contacts[row.index()];
  }
  /// Whether the row's body is disabled by an intervention or a program, or dropped out by a fault. The
  /// devices, controllers and drive of such a body do not run. The body does not move on its own, but it
  /// still blocks motions and is visible to sensors.
  bool is_disabled(Row row) const {
    return columns_.now->impaired > 0 && columns_.conditions[row.index()].out != 0;
  }
  /// Whether the state has the component `condition`, because bodies can be disabled or have faults.
  bool has_conditions() const { return !columns_.conditions.empty(); }
  /// Bodies for which World::subscribe() was called and which have a row here, in ascending order of ids.
  std::vector<BodyId> subscribed() const;
  /// Position of the row's body at its birth, or at tick 0 if it was present then; m, world frame. For an
  /// unborn body it is (0, 0).
  Vec2 origin(Row row) const;
  /// runs(row, device): whether the row's device runs in the ticks in which it is due. A device is due once
  /// per BodyType::Device::period. It then runs if senses(), is_on(), works() and is_supplied() are all true
  /// for it.
  using SensingView::runs;
};

}  // namespace troupe::engine
