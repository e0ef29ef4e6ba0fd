#pragma once

#include "base/assert.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/mount.hpp"
#include "engine/sensing/fixed_targets.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/body_names.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"
#include "engine/state/free_circle.hpp"
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

/// Consecutive rows: from `first` up to but not including `end`. A row is the index of a body in the state
/// tables (WorldState).
struct RowRange {
  std::size_t first = 0;  ///< the first row
  std::size_t end = 0;    ///< one past the last row
};
/// Returns those rows of the list `order` that are in `range`, in the same order. The result is stored in
/// `rows`, and is valid as long as `rows` does not change.
std::span<const std::uint32_t> rows_within(std::span<const std::uint32_t> order, const RowRange& range,
                                           std::vector<std::uint32_t>& rows);

/// The data of a World: constants that describe the world, the state, what the program has set, and data that
/// are derived from the state, such as the outlines of bodies in the world frame and the spatial index. World
/// owns this object. The parts of World, such as Links and Movement, read and write it.
///
/// The state is stored in tables; each table holds one *component* of the state, such as the poses. A tick is
/// a time step. The words below have these meanings:
/// - *spec*: the description from which the world is made.
/// - *static*: a static body does not move during a run, and has no row.
/// - *row*: the index of a body in the state tables.
/// - *slot*: the index of a body in the tables of its type, which have entries only for bodies of this type.
/// - *unborn*, *dead*: an unborn body is not yet in the world, and a dead body no longer is.
/// - *device*: a sensor or other equipment of a body.
/// - *joint*: a frame of a body that a device moves. It is *at rest* while its displacement is zero.
/// - *rank*: one of several threads or processes that compute the world together. Each rank has a World of
///   its own, which may lack rows.
/// - *public*: devices of any body may read the data (PublicColumns). All other data are private to the
///   engine.
///
/// Every vector has one element per row unless its comment says otherwise.
struct WorldState {
  /// Indices in `tables` of the tables that every world has. Each enumerator is named like the component.
  enum TableIndex : std::size_t {
    k_pose,      ///< Pose of the body
    k_velocity,  ///< Velocity of the drive
    k_command,   ///< Command to the drive
    k_stall,     ///< outcome of the last motion: a value of Stall
  };

  /// The place of the bodies of one type in the lists `outlines` and `joint_mounts`. In each list, the
  /// entries of slot 0 come first, then those of slot 1, and so on.
  struct Pool {
    std::size_t rows = 0;  ///< number of bodies of the type that have a row, on all ranks together
    /// Number of slots for which the two lists have room. Equal to `rows` if no body of the type has its row
    /// on another rank. Otherwise it is at least the number of bodies of the type that have their rows here.
    std::size_t slots = 0;
    std::size_t outlines = 0;  ///< index in WorldState::outlines of the first vertex of slot 0
    std::uint32_t joints = 0;  ///< index in WorldState::joint_mounts of the first joint of slot 0
  };

  // Constants: made from the spec when the world is built.
  WorldSpec spec;  ///< the spec that the world was made from; constant except for what World::set() and
                   ///< World::restart() change
  BodyNames names{spec};  ///< finds bodies by their names
  /// The body types, compiled from WorldSpec::types and indexed by TypeId. Only their parameters can change
  /// during a run, by interventions (changes at given times).
  std::vector<BodyType> types;
  partition::GridGeometry geometry;  ///< sizes of the squares (cells and tiles) of `index`
  partition::StaticScene scene;      ///< geometry of the static bodies
  FixedTargets fixed_targets;        ///< parts of static bodies that fiducial finders (marker sensors) detect
  std::vector<Pool> pools;           ///< one per type, by TypeId; changes when rows come or leave
  /// Number of rows that this World computes. These rows come first. All later rows are *ghosts*: copies of
  /// rows that other ranks compute (engine/ranks/halo.hpp).
  std::size_t own_rows = 0;
  std::vector<BodyId> bodies;               ///< public: body of each row
  std::vector<Row> rows;                    ///< public: row of each body, by BodyId; see PublicColumns::rows
  std::vector<std::uint32_t> row_types;     ///< public: TypeId of each row
  std::vector<std::uint32_t> slots;         ///< public: slot of each row
  std::vector<std::uint32_t> ids;           ///< the ids of `bodies` as numbers (BodyId::value)
  std::vector<std::size_t> outline_begins;  ///< public: index of the row's first vertex in `outlines`
  /// Public: index in `joint_mounts` of the row's first joint. The vector is empty if no type has joints or
  /// can carry bodies.
  std::vector<std::uint32_t> joint_begins;
  /// Index in `tables` of the component `carrier`, which says which body carries which. Not set: no body can
  /// carry another.
  std::optional<std::size_t> carrier_table;
  /// Index in `tables` of the component `life`, which says which bodies are in the world. Not set: no body
  /// can be born or die.
  std::optional<std::size_t> life_table;
  /// Index in `tables` of the component `condition`, which says which bodies are disabled or have faults. Not
  /// set: no body can be disabled or have a fault.
  std::optional<std::size_t> condition_table;

  /// Index in `tables` of the component `contact`, which says what blocked the bodies. Not set: the state has
  /// no such component, because nothing that the world contains reads it.
  std::optional<std::size_t> contact_table;

  // State.
  std::vector<StateTable> tables;  ///< the state tables
  TickCounts now;  ///< number of the tick, which is state, and counts of certain rows, which are derived

  // Set by the program.
  std::vector<std::uint8_t> subscribed;  ///< public: 1 if World::subscribe() was called for the body
  bool watches_contacts = false;         ///< whether World::watch_contacts() was called
  /// What blocked the body of each row in the last tick, if `watches_contacts`, but the state has no
  /// component for it; otherwise empty. No later tick depends on it.
  std::vector<Contact> contacts;

  // Derived.
  std::vector<Transform> transforms;  ///< public: the poses as transforms
  std::vector<Vec2> outlines;         ///< public: vertices of the outlines of all rows, world frame, m
  std::vector<double> radii;          ///< public: bounding radius about the origin, m; < 0: not in the world
  /// Public: one element for each joint of each row. The element is the transform that takes a point on the
  /// joint from its place with all joints at rest to its present place, in the body frame.
  std::vector<Mount> joint_mounts;
  /// Public: row of the *root* of the row's body. If A carries B and B carries C, then A is the root of A, B
  /// and C. A body that neither carries others nor is carried is its own root. The vector is empty if no type
  /// has joints or can carry bodies.
  std::vector<std::uint32_t> roots;
  /// The shapes with which bodies collide, in the body frame. A body that is unborn, dead or carried has
  /// k_no_shape. The shape of any other body includes the shapes of all bodies that it carries, directly or
  /// through others.
  std::vector<const partition::ObstacleShape*> shapes;
  std::vector<FreeCircle> free_circles;  ///< what conflict resolution knows of the surroundings of each body
  /// 1 if the row's body is unborn or dead, otherwise 0. The grid ray engine uses it: this engine draws the
  /// outlines of bodies into a grid of cells and traces rays through the cells. It does not draw bodies with
  /// the value 1. The vector is empty if no body can be born or die, or if the world does not use this
  /// engine.
  std::vector<std::uint8_t> not_drawn;
  partition::BodyIndex index;                    ///< spatial index of the bodies in the world
  std::unique_ptr<partition::RayGrid> ray_grid;  ///< cells of the grid ray engine; null: not used

  CommittedView view;  ///< the view of this state that devices get; bind_view() updates it

  WorldState() = default;
  WorldState(const WorldState&) = delete;
  WorldState& operator=(const WorldState&) = delete;

  /// Computes the place of each pool in `outlines` and `joint_mounts` from the numbers of slots
  /// (Pool::slots). Resizes `outlines`, but does not compute the vertices.
  void place_pools();
  /// Updates `view`, which refers to the vectors and tables of this struct. Call this after their memory has
  /// moved, for example because rows were added, and after `ray_grid` was set.
  void bind_view();

  std::size_t row_count() const { return bodies.size(); }  ///< number of rows
  /// Type of any body, static or not.
  const BodyType& type(BodyId body) const { return types[spec.bodies[body.index()].type.index()]; }
  /// Type of the row's body.
  const BodyType& type(Row row) const { return types[row_types[row.index()]]; }
  /// All rows of a table, each as a struct T. The members of T must be the fields of the table, and the
  /// layout of the table must be StateTable::Layout::rows, with rows of the size of T. `table` is an index
  /// into `tables`.
  ///@{
  template <class T>
  std::span<T> as(std::size_t table) {
    TROUPE_ASSERT(tables[table].has_rows_of<T>());
    return {reinterpret_cast<T*>(tables[table].row(0)), tables[table].rows()};
  }
  template <class T>
  std::span<const T> as(std::size_t table) const {
    TROUPE_ASSERT(tables[table].has_rows_of<T>());
    return {reinterpret_cast<const T*>(tables[table].row(0)), tables[table].rows()};
  }
  ///@}
  /// The component `pose`: pose of the body of each row, world frame.
  ///@{
  std::span<Pose> poses() { return as<Pose>(k_pose); }
  std::span<const Pose> poses() const { return as<Pose>(k_pose); }
  ///@}
  /// The component `stall`: a value of Stall for each row.
  ///@{
  std::span<std::uint8_t> stalls() { return tables[k_stall].column<std::uint8_t>(0); }
  std::span<const std::uint8_t> stalls() const { return tables[k_stall].column<std::uint8_t>(0); }
  ///@}
  /// Box that the origins of bodies cannot leave, m, world frame: WorldSpec::bounds or, if that is not set,
  /// its default.
  Box bounds() const;
  /// The entry of a row in the component `carrier`. The world must have this component: carrier_table must be
  /// set.
  ///@{
  Carried& carried(std::uint32_t row) { return tables[*carrier_table].as<Carried>(row); }
  const Carried& carried(std::uint32_t row) const { return tables[*carrier_table].as<Carried>(row); }
  ///@}
  /// The entry of a row in the component `life`. The world must have this component: life_table must be set.
  Life& life(Row row) { return tables[*life_table].as<Life>(row.index()); }
  /// The entry of a row in the component `condition`. The world must have this component: condition_table
  /// must be set.
  ///@{
  Condition& condition(Row row) { return tables[*condition_table].as<Condition>(row.index()); }
  const Condition& condition(Row row) const { return tables[*condition_table].as<Condition>(row.index()); }
  ///@}
  /// Whether it is known what blocked the bodies in the last tick: contact() may be called.
  bool has_contacts() const { return contact_table || watches_contacts; }
  /// What blocked the row's body in the last tick.
  ///@{
  Contact& contact(Row row) {
    return contact_table ? tables[*contact_table].as<Contact>(row.index()) : contacts[row.index()];
  }
  const Contact& contact(Row row) const {
    return contact_table ? tables[*contact_table].as<Contact>(row.index()) : contacts[row.index()];
  }
  ///@}
  /// Present pose of a joint of the row's body, relative to the pose of the joint at rest, m and rad. `joint`
  /// is an index into BodyType::joints.
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

  /// Index in `outlines` of the first vertex of the body with this type (a TypeId value) and slot.
  std::size_t outline_begin(std::uint32_t type, std::uint32_t slot) const {
    return pools[type].outlines + slot * types[type].outline_vertices.size();
  }
  /// Index in `joint_mounts` of the first joint of the body with this type (a TypeId value) and slot.
  std::uint32_t joint_begin(std::uint32_t type, std::uint32_t slot) const {
    return pools[type].joints + slot * static_cast<std::uint32_t>(types[type].joints.size());
  }
  /// Updates the elements of a row in `shapes`, `radii` and `not_drawn`, depending on whether its body is in
  /// the world. If it is, shape and radius become those of the type. Otherwise the shape becomes k_no_shape,
  /// and the radius the negative value partition::k_not_there. If a body of the world has joints or can carry
  /// others, call Links::reshape() afterwards: it corrects shape and radius for moved joints and carried
  /// bodies.
  void update_presence(Row row);
  /// Stores the pose of a row as a transform, and computes the vertices of the row's outlines in the world
  /// frame, with the joints where they are now. `type` must be the type of the row's body. `transform` must
  /// be the pose of that body.
  void update_outlines(Row row, const BodyType& type, const Transform& transform) {
    transforms[row.index()] = transform;
    if (!type.joints.empty()) return update_jointed_outlines(row, type, transform);
    Vec2* out = outlines.data() + outline_begins[row.index()];
    for (const Vec2& v : type.outline_vertices) *out++ = transform * v;
  }
  /// Sets every field of the row's state to 0, in all tables.
  void clear(Row row);
  /// Returns the index of the row's body in a state table. The table must have an entry for the body.
  /// Otherwise the result is meaningless, and may be out of range; find_in() checks this.
  std::size_t row_in(const StateTable& table, Row row) const {
    // A table has a row for each body, at the body's row, or for each body of one type, at the body's slot.
    const std::size_t r = row.index();
    return r < table.rows() && table.ids()[r] == bodies[r] ? r : slots[r];
  }
  /// Returns the index of the row's body in a state table; std::nullopt if the table has no entry for the
  /// body.
  std::optional<std::size_t> find_in(const StateTable& table, Row row) const {
    const std::size_t at = row_in(table, row);
    if (at < table.rows() && table.ids()[at] == bodies[row.index()]) return at;
    return std::nullopt;
  }
  /// Calls visit(t, i) for each state table that has an entry for the row's body: t is the index of the table
  /// in `tables`, and i is the index of the body in that table.
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

/// Returns the end of an error message about a position that is out of bounds. For example:
/// `outside the world's bounds (x -5 to 5, y -5 to 5 m)`.
std::string outside_text(const Box& bounds);

}  // namespace troupe::engine
