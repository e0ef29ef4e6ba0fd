#pragma once

#include "engine/fields/state_table.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/kinds/mount.hpp"
#include "engine/sensing/fixed_targets.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/body_index.hpp"
#include "partition/overlap.hpp"
#include "partition/parallel.hpp"
#include "partition/ray_grid.hpp"
#include "partition/static_scene.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// Consecutive rows: from `first` up to but not including `end`.
struct RowRange {
  std::size_t first = 0;  ///< the first row
  std::size_t end = 0;    ///< one past the last row
};
/// Returns those rows of `order` that are in `range`, in the same order. The result is stored in `rows`, and
/// is valid as long as `rows` does not change.
std::span<const std::uint32_t> rows_within(std::span<const std::uint32_t> order, const RowRange& range,
                                           std::vector<std::uint32_t>& rows);

/// The state of a world, the constants that describe the world, what the program has set, and data that are
/// derived from the state: the transforms, outlines, radii and shapes of bodies, and the spatial index. World
/// owns this object. The parts of World (Links, Movement) read all members, and each part writes its own
/// columns. A component is one of the state tables, such as the poses. The *spec* is the description from
/// which the world is made. A tick is a time step.
///
/// A row is the index of a body in the state tables; static bodies, which do not move during a run, have
/// none. An unborn body is not yet in the world, and a dead body no longer is. A device is a sensor or other
/// equipment of a body. A joint, which devices move, is *at rest* in its initial pose. Every vector has one
/// element per row unless stated otherwise. Members that a comment calls public are also part of
/// PublicColumns: the devices of any body may read them. All other members are private to the engine.
struct WorldState {
  /// Indices into `tables` of the tables that every world has, named like their components.
  enum TableIndex : std::size_t {
    k_pose,      ///< Pose of the body
    k_velocity,  ///< Velocity of the drive
    k_command,   ///< Command to the drive
    k_stall,     ///< whether the last motion was blocked: Stall
  };
  /// Values of the component `stall`: the outcome of the last motion.
  enum Stall : std::uint8_t {
    k_free,           ///< the motion was carried out, or there was none
    k_blocked,        ///< another body, mobile or static, was in the way
    k_out_of_bounds,  ///< the motion would have ended outside the bounds of the world
  };

  /// The storage of the bodies of one type: entries in the tables of the type and in the lists of vertices
  /// and joints. The slot of a body is its index among these entries.
  struct Pool {
    std::size_t rows = 0;  ///< number of bodies of the type in the whole world
    /// Number of slots: `rows`, unless some of the bodies are on other ranks (threads or processes that
    /// compute the same world).
    std::size_t slots = 0;
    std::size_t outlines = 0;  ///< index in WorldState::outlines of the first vertex of slot 0
    std::uint32_t joints = 0;  ///< index in WorldState::joint_mounts of the first joint of slot 0
  };

  // Constants: made from the spec when the world is built.
  WorldSpec spec;  ///< the spec that the world was made from; constant except for what World::set() and
                   ///< World::restart() change
  /// Compiled types, by TypeId; constant except for parameters, which interventions (changes at given times)
  /// change.
  std::vector<BodyType> types;
  partition::GridGeometry geometry;  ///< sizes of the cells and tiles of `index`
  partition::StaticScene scene;      ///< geometry of the static bodies
  FixedTargets fixed_targets;        ///< marked parts of static bodies, which fiducial finders detect
  std::vector<Pool> pools;           ///< one per type, by TypeId; changes when rows come or leave
  /// Number of rows at the front that this world computes; the rows after them are *ghosts*, copies of rows
  /// that other ranks compute (engine/ranks/halo.hpp). All rows, if the world has no ghosts.
  std::size_t own_rows = 0;
  std::vector<BodyId> bodies;               ///< public: body of each row
  std::vector<Row> rows;                    ///< public: row of each body, by BodyId; see view.row()
  std::vector<std::uint32_t> row_types;     ///< public: TypeId of each row
  std::vector<std::uint32_t> slots;         ///< public: index of each row among the rows of its type
  std::vector<std::uint32_t> ids;           ///< the ids of `bodies` as numbers (BodyId::value)
  std::vector<std::size_t> outline_begins;  ///< public: index of the row's first vertex in `outlines`
  /// Public: index of the row's first joint in `joint_mounts`; empty if no type has joints or can carry
  /// bodies.
  std::vector<std::uint32_t> joint_begins;
  /// Index of the component `carrier` in `tables`; not set: no body can carry another.
  std::optional<std::size_t> carrier_table;
  /// Index of the component `life` in `tables`; not set: no births and deaths.
  std::optional<std::size_t> life_table;
  /// Index of the component `condition` in `tables`; not set: no faults, no disabled bodies.
  std::optional<std::size_t> condition_table;

  // State.
  std::vector<StateTable> tables;  ///< the state tables
  TickCounts now;  ///< number of the tick, which is state, and counts of certain rows, which are derived

  // Set by the program.
  std::vector<std::uint8_t> subscribed;  ///< public: 1 if World::subscribe() was called for the body

  // Derived.
  std::vector<Transform> transforms;  ///< public: the poses as transforms
  std::vector<Vec2> outlines;         ///< public: vertices of the outlines of all rows, world frame, m
  std::vector<double> radii;          ///< public: bounding radius about the origin, m; < 0: not in the world
  /// Public: for all joints of all rows, the transform that takes a point on the joint from its place with
  /// all joints at rest to its present place; body frame.
  std::vector<Mount> joint_mounts;
  /// Public: row of the body that carries the row's body, directly or through others, and is not carried
  /// itself (the root); the row itself if its body is not carried. Empty, like joint_begins, if no type has
  /// joints or can carry bodies.
  std::vector<std::uint32_t> roots;
  /// Obstacle shapes, body frame, for conflict resolution. k_no_shape for bodies that are unborn, dead or
  /// carried. For a body that carries others and is not carried itself: the common shape of the body and of
  /// all bodies that it carries, directly or through others.
  std::vector<const partition::ObstacleShape*> shapes;
  /// 1 if the grid ray engine, which draws outlines into a grid of cells and traces rays through it, does not
  /// draw the row's outlines. Empty unless bodies can be born or die and the world uses that engine.
  std::vector<std::uint8_t> not_drawn;
  partition::BodyIndex index;                    ///< spatial index of the bodies in the world
  std::unique_ptr<partition::RayGrid> ray_grid;  ///< cells of the grid ray engine; null: exact engine

  CommittedView view;  ///< the view of this state that devices get; bind_view() updates it

  WorldState() = default;
  WorldState(const WorldState&) = delete;
  WorldState& operator=(const WorldState&) = delete;

  /// Gives each pool its place in `outlines` and `joint_mounts`, and resizes `outlines`. Call this after
  /// Pool::slots were set. Does not compute the outlines.
  void place_pools();
  /// Updates `view`. Call this after a vector or table was allocated again, or `ray_grid` was set.
  void bind_view();

  std::size_t row_count() const { return bodies.size(); }  ///< number of rows
  /// Type of a body, which may have no row.
  const BodyType& type(BodyId body) const { return types[spec.bodies[body.index()].type.index()]; }
  /// Type of the row's body.
  const BodyType& type(Row row) const { return types[row_types[row.index()]]; }
  /// The rows of a table as structs. The values of each row must be contiguous (StateTable::Layout::rows).
  /// `table` is an index into `tables`.
  ///@{
  template <class T>
  std::span<T> as(std::size_t table) {
    return {reinterpret_cast<T*>(tables[table].row(0)), tables[table].rows()};
  }
  template <class T>
  std::span<const T> as(std::size_t table) const {
    return {reinterpret_cast<const T*>(tables[table].row(0)), tables[table].rows()};
  }
  ///@}
  /// The component `pose`: pose of each row, world frame.
  ///@{
  std::span<Pose> poses() { return as<Pose>(k_pose); }
  std::span<const Pose> poses() const { return as<Pose>(k_pose); }
  ///@}
  /// The component `stall`: a Stall for each row.
  ///@{
  std::span<std::uint8_t> stalls() { return tables[k_stall].column<std::uint8_t>(0); }
  std::span<const std::uint8_t> stalls() const { return tables[k_stall].column<std::uint8_t>(0); }
  ///@}
  /// Box in which motions must end, m, world frame: WorldSpec::bounds or its default.
  Box bounds() const;
  /// The component `carrier` of a row. The world must have this component.
  ///@{
  Carried& carried(std::uint32_t row) { return tables[*carrier_table].as<Carried>(row); }
  const Carried& carried(std::uint32_t row) const { return tables[*carrier_table].as<Carried>(row); }
  ///@}
  /// The component `life` of a row. The world must have this component.
  Life& life(Row row) { return tables[*life_table].as<Life>(row.index()); }
  /// The component `condition` of a row. The world must have this component.
  ///@{
  Condition& condition(Row row) { return tables[*condition_table].as<Condition>(row.index()); }
  const Condition& condition(Row row) const { return tables[*condition_table].as<Condition>(row.index()); }
  ///@}
  /// Present pose of a joint relative to its rest pose, m and rad. `joint` is an index into BodyType::joints.
  ///@{
  Pose& joint_state(Row row, std::size_t joint) {
    return tables[type(row).joints[joint].table].as<Pose>(slots[row.index()]);
  }
  const Pose& joint_state(Row row, std::size_t joint) const {
    return tables[type(row).joints[joint].table].as<Pose>(slots[row.index()]);
  }
  ///@}
  /// The elements of `joint_mounts` that belong to a row, one per joint.
  ///@{
  std::span<Mount> mounts(Row row) {
    return {joint_mounts.data() + joint_begins[row.index()], type(row).joints.size()};
  }
  std::span<const Mount> mounts(Row row) const {
    return {joint_mounts.data() + joint_begins[row.index()], type(row).joints.size()};
  }
  ///@}

  /// Index in `outlines` of the first vertex of a slot of a type.
  std::size_t outline_begin(std::uint32_t type, std::uint32_t slot) const {
    return pools[type].outlines + slot * types[type].outline_vertices.size();
  }
  /// Index in `joint_mounts` of the first joint of a slot of a type.
  std::uint32_t joint_begin(std::uint32_t type, std::uint32_t slot) const {
    return pools[type].joints + slot * static_cast<std::uint32_t>(types[type].joints.size());
  }
  /// Sets the obstacle shape and radius of a row to those of its type or, if its body is unborn or dead, to
  /// k_no_shape and the negative radius partition::k_not_there. Also updates `not_drawn`. If bodies can have
  /// joints or carry others, Links::reshape() must then compute the exact shape and radius.
  void update_presence(Row row);
  /// Updates the data that are derived from a row's pose and joints: stores the transform, and computes the
  /// vertices of the outlines in the world frame. `type` is the type of the row, and `transform` its pose.
  void update_outlines(Row row, const BodyType& type, const Transform& transform) {
    transforms[row.index()] = transform;
    if (!type.joints.empty()) return update_jointed_outlines(row, type, transform);
    Vec2* out = outlines.data() + outline_begins[row.index()];
    for (const Vec2& v : type.outline_vertices) *out++ = transform * v;
  }
  /// Sets every field of the row's state to 0, in all tables.
  void clear(Row row);
  /// Index of the row's body in a state table. If the table has no row for the body, the result is the index
  /// of another body, or is not below StateTable::rows().
  std::size_t row_in(const StateTable& table, Row row) const {
    // A table has a row for each body, at the body's row, or for each body of one type, at the body's slot.
    const std::size_t r = row.index();
    return r < table.rows() && table.ids()[r] == bodies[r] ? r : slots[r];
  }
  /// Index of the row's body in a state table; not set: the table has no row for the body.
  std::optional<std::size_t> find_in(const StateTable& table, Row row) const {
    const std::size_t at = row_in(table, row);
    if (at < table.rows() && table.ids()[at] == bodies[row.index()]) return at;
    return std::nullopt;
  }
  /// Calls visit(t, i) for each state table t that has a row for the row's body; i is the index of that row.
  template <class Visit>
  void for_tables_of(Row row, Visit&& visit) {
    for (std::size_t t = 0; t < tables.size(); ++t)
      if (const std::optional<std::size_t> at = find_in(tables[t], row)) visit(t, *at);
  }

 private:
  void update_jointed_outlines(Row row, const BodyType& type, const Transform& transform);
};

/// An empty shape: the obstacle shape of a body that is not in the world, or that another body carries.
extern const partition::ObstacleShape k_no_shape;

/// The end of an error message about a position: `outside the world's bounds (x -5 to 5, y -5 to 5 m)`.
std::string outside_text(const Box& bounds);

}  // namespace troupe::engine
