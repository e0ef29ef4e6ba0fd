#pragma once

#include "engine/body_type.hpp"
#include "engine/conflicts.hpp"
#include "engine/experiment.hpp"
#include "engine/fixed_targets.hpp"
#include "engine/kinds.hpp"
#include "engine/links.hpp"
#include "engine/phase.hpp"
#include "engine/state_table.hpp"
#include "engine/world_spec.hpp"
#include "partition/body_index.hpp"
#include "partition/parallel.hpp"
#include "partition/ray_grid.hpp"
#include "partition/static_scene.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

// engine/frame.hpp
struct Frame;
struct FrameScene;
struct FrameType;

/// Options of a run. None of them changes a result.
struct WorldOptions {
  unsigned threads = 0;    ///< 0: one per processor that the process may use; see partition::Parallel
  double tile_size_m = 0;  ///< 0: chosen from body sizes and sensor ranges
};

/// A step cannot be completed: a value is not a finite number, or a function of a kind threw. The text names
/// the tick and the robot.
class StepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The hash of a state (docs/determinism.md) and its summands, modulo 2^64.
struct Hashes {
  std::uint64_t state = 0;                            ///< sum over all tables
  std::array<std::uint64_t, k_hash_groups> groups{};  ///< sum over the tables of each HashGroup
};

/// Whether a body is in the world.
enum class Presence : std::uint8_t {
  there,   ///< in the world
  unborn,  ///< in a reserve
  dead,    ///< died, and never comes back
};

/// A running world: constants made from a WorldSpec, the state tables, and the tick.
///
/// S(k+1) = step(S(k)) is a pure function of the state, the spec and the seed.
class World {
 public:
  /// Throws InputError for errors that a loader cannot find (kinds without their sensors, ...). Bodies that
  /// overlap at tick 0 give one warning with the number of pairs, counted up to 10,000; thorough diagnostics
  /// list the first hundred. The registry must outlive the world.
  World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics);
  World(WorldSpec, Registry&&, const WorldOptions&, Diagnostics&) = delete;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // ---- the tick: engine/step.cpp
  /// From S(k) to S(k+1). Throws StepError if a value is not a finite number or a function of a kind throws,
  /// and passes on what a callback throws. The state is then incomplete, see require_whole(). After the first
  /// steps it allocates no memory.
  void step();
  /// Throws std::logic_error if a step threw and no reset(), restart() or restore() followed: the state then
  /// belongs to no tick. All functions that read or continue the state as a whole call this first:
  /// step(), hashes(), tables(), frame(), spawn(), remove() and the set_ functions. Accessors of single rows
  /// do not.
  void require_whole() const {
    if (is_half_made_) throw_half_made();
  }
  /// Back to S(0): tables, tick, counters and everything derived from them are as after construction.
  /// Callbacks and subscriptions stay. Allocates nothing. May be called after a step that threw.
  void reset();
  /// To S(0) of the same world with another seed: results are those of a new world from a spec with this seed
  /// and these bodies. Only the order of the rows may differ. Callbacks and subscriptions stay. May be called
  /// after a step that threw.
  /// bodies: one for each body of the spec, with the same names and types; poses and colours may differ. If a
  /// static body has another pose, the static scene is rebuilt.
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry);
  /// Counters of a run since tick 0. They are not part of the state.
  struct Counters {
    std::uint64_t beams = 0;            ///< rays cast by all sensors
    std::uint64_t conflict_rounds = 0;  ///< rounds of conflict resolution, see Conflicts::rounds()
  };
  Counters counters() const { return {beams_, conflict_rounds_}; }  ///< values up to now
  /// Sets every field of every row. It is given tables in which every byte is 0.
  using Fill = std::function<void(std::span<StateTable>)>;
  /// Restores a saved state, and derives again what is derived from the tables. Returns false, with the world
  /// at S(0), if the state has another hash or values that no state has, such as a NaN in a pose. If `fill`
  /// throws, the world is at S(0) too.
  bool restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash, const Fill& fill);
  /// Overwrites everything that is neither constant, nor state, nor set by the program with junk, and derives
  /// it again. For tests that a run then continues with the same bits ("amnesia", docs/determinism.md).
  void forget();
  std::uint64_t tick() const { return tick_; }    ///< ticks completed
  double tick_s() const { return spec_.tick_s; }  ///< length of a tick, s
  /// World time: tick() * tick_s().
  double time_s() const { return static_cast<double>(tick_) * spec_.tick_s; }
  /// Sets the callback that is called when each phase begins, and with no phase when a tick ends.
  void on_phase(std::function<void(std::optional<Phase>)> callback) { on_phase_ = std::move(callback); }
  /// Sets the callback that each step calls after the interventions and faults of the world's file, before
  /// the tick begins. It may change the world as a program may between two steps. step() passes on what it
  /// throws. Replaces the previous callback; to be called between steps.
  void before_tick(std::function<void()> callback) { before_tick_ = std::move(callback); }
  /// Called in place of a controller for a batch of robots; must itself call
  /// controller.kind->decide(controller.data, batch). Several workers call it at once, so it must be
  /// thread-safe. For checks of controllers.
  using OnDecide =
      std::function<void(const BodyType& type, const BodyType::Controller& controller, const DecideBatch&)>;
  /// Replaces the callback; an empty one restores the direct call. To be called between steps.
  void on_decide(OnDecide callback) { on_decide_ = std::move(callback); }

  // ---- constants and indices
  const WorldSpec& spec() const { return spec_; }                 ///< of this world
  std::span<const BodyType> types() const { return types_; }      ///< by TypeId
  const partition::StaticScene& scene() const { return scene_; }  ///< static bodies
  /// Spatial index of the rows, as of the end of the last step.
  const partition::BodyIndex& index() const { return index_; }
  /// Fiducials of the static scene.
  const FixedTargets& fixed_targets() const { return fixed_targets_; }
  /// Cells of the grid ray engine; null if the world uses the exact one.
  const partition::RayGrid* ray_grid() const { return ray_grid_.get(); }
  /// Cells and tiles of the sparse grid; no result depends on them.
  const partition::GridGeometry& geometry() const { return geometry_; }
  /// The workers of step(), which measures may use between steps.
  partition::Parallel& parallel() { return parallel_; }
  /// Number of rows: bodies that can move, sense, decide, be gripped or be pushed, ordered by their place at
  /// tick 0.
  std::size_t rows() const { return row_bodies_.size(); }
  /// Number of robots, that is rows with a drive, that are in the world at tick 0.
  std::size_t robots_at_start() const { return robots_at_start_; }
  /// Number of robots that are in the world now.
  std::size_t robots() const { return robots_; }
  BodyId body(Row row) const { return row_bodies_[row.index()]; }  ///< body of a row
  /// Row of a body; not valid for static bodies.
  Row row(BodyId body) const { return body_rows_[body.index()]; }
  const BodyType& type(Row row) const { return types_[row_types_[row.index()]]; }  ///< type of the row's body
  /// Position of a row among the rows of its type: its row in the type's tables.
  std::size_t slot(Row row) const { return row_slots_[row.index()]; }
  /// Body with a name or alias; not valid if there is none. If several have the name, the last one.
  /// Thread-safe.
  BodyId find(std::string_view name) const;

  // ---- the state
  /// The state tables; BodyType refers to them by their index here.
  std::span<const StateTable> tables() const {
    require_whole();
    return tables_;
  }
  /// Pose of each row, world frame; for a dead body where it died.
  std::span<const Pose> poses() const { return as<Pose>(k_pose); }
  Pose pose(BodyId body) const;  ///< of any body, also a static one, world frame; NaN if it is unborn
  /// Transform(pose) of the row's pose, bit for bit, computed once per tick.
  const Transform& transform(Row row) const { return transforms_[row.index()]; }
  /// Velocity from each row's drive, body frame, m/s and rad/s, also if the motion was blocked.
  std::span<const Velocity> velocities() const { return as<Velocity>(k_velocity); }
  /// Command of each row's drive.
  std::span<const Command> commands() const { return as<Command>(k_command); }
  /// Whether the row's last motion was blocked or would have ended out of bounds.
  bool stalled(Row row) const;
  /// Whether the row's last motion would have ended out of bounds.
  bool is_out_of_bounds(Row row) const;
  /// Estimated pose of a robot: engine/localization.hpp.
  Pose estimate(Row row) const { return estimates(type(row)).of(row, slot(row)); }
  Estimates estimates(const BodyType& type) const;  ///< of all robots of a type
  /// Overwrites the odometry estimate of a robot. Throws std::logic_error if the robot has no odometry,
  /// std::invalid_argument if the pose is not finite.
  void set_estimate(Row row, const Pose& pose);
  /// Overwrites the command of a robot's drive; between steps.
  void set_command(Row row, const Command& command) {
    require_whole();
    tables_[k_command].as<Command>(row.index()) = command;
  }
  /// Frame for the type's poses of parts and devices on a joint, world frame: the row's pose, moved by the
  /// joint's present displacement. With k_rigid it is the row's pose.
  Mount mount(Row row, std::int32_t joint) const;
  /// Greatest distance of the body's surface from its origin, with its joints where they are now, m.
  double radius(Row row) const { return row_radii_[row.index()]; }
  /// Height by which a joint has raised the parts on it, m.
  double lift(Row row, std::int32_t joint) const {
    return joint == k_rigid
               ? 0.0
               : links_.joints[links_.joint_begins[row.index()] + static_cast<std::size_t>(joint)].now.z;
  }
  /// Pose of a joint, relative to its rest pose.
  const Pose& joint_state(Row row, std::size_t joint) const;
  /// The body that carries the row's body; not set if it is not carried.
  std::optional<BodyId> carrier(Row row) const;
  /// Number of carried bodies.
  std::size_t carried_count() const { return links_.carried; }
  /// Whether two bodies move as one: one carries the other, directly or not, or a third carries both.
  bool same_tree(Row a, Row b) const {
    return a == b || (links_.carried > 0 && links_.roots[a.index()] == links_.roots[b.index()]);
  }
  /// Makes a body move with a carrier, or with one of its joints, in its present relative pose. Returns false
  /// and changes nothing if the body is carried already, carries the carrier itself, or the carrier cannot
  /// carry. To be called by DeviceKind::apply.
  bool attach(Row cargo, Row carrier, std::int32_t joint);
  /// Detaches a body from its carrier; its pose stays. To be called by DeviceKind::apply.
  void release(Row cargo);

  // ---- births and deaths: engine/lives.cpp
  /// Whether bodies may be born or die: the world has reserves, something in it ends lives, or its spec says
  /// that it is mortal. Only then does it have the component `life`.
  bool has_lives() const { return life_table_.has_value(); }
  /// Presence of the row's body; Presence::there in a world without lives.
  Presence presence(Row row) const {
    return life_table_ ? static_cast<Presence>(tables_[*life_table_].as<Life>(row.index()).presence)
                       : Presence::there;
  }
  /// Whether the row's body is in the world. An absent body is not indexed, and does not sense, decide or
  /// move. Its state is 0, except for the component `life` and the pose of a dead body.
  bool is_there(Row row) const { return absent_ == 0 || presence(row) == Presence::there; }
  /// Number of rows whose bodies are unborn or dead.
  std::size_t absent_count() const { return absent_; }
  /// Position at birth or at tick 0, m, world frame.
  Vec2 origin(Row row) const;
  /// Tick after which its life began. Periods of its devices, drive and controllers count from there.
  std::uint64_t birth_tick(Row row) const {
    return life_table_ ? tables_[*life_table_].as<Life>(row.index()).birth : 0;
  }
  /// Reserve of a population, as an index into WorldSpec::reserves; not set if it has none.
  std::optional<std::size_t> reserve(std::string_view population) const;
  /// Number of unborn bodies of a reserve.
  std::size_t unborn(std::size_t reserve) const {
    return spec_.reserves[reserve].count - next_born_[reserve];
  }
  /// Spawns the next body of a reserve, between steps, if the pose is free; otherwise the result says why
  /// not. Its state begins as that of other bodies at tick 0. Throws std::invalid_argument if the pose is not
  /// finite. Rebuilds the index of all bodies.
  Birth spawn(std::size_t reserve, const Pose& pose);
  /// Removes a body, between steps; bodies that it carries stay where they are. Does nothing if it is not in
  /// the world. Throws std::logic_error in a world without lives. Rebuilds the index of all bodies.
  void remove(Row row);

  // ---- experiments: engine/experiment.cpp
  /// Whether the row's body is disabled, by an intervention or by a fault: its devices, controllers and drive
  /// do not run. It stays where it is, blocks motions and is visible.
  bool is_disabled(Row row) const { return impaired_ > 0 && condition(row).out != 0; }
  /// Whether the row's device is neither broken nor disabled with its body: see Condition.
  bool works(Row row, const BodyType::Device& device) const {
    if (impaired_ == 0) return true;
    const Condition& now = condition(row);
    const auto d = static_cast<std::size_t>(&device - type(row).devices.data());
    return now.out == 0 && (d >= k_most_fallible || (now.dead >> d & 1) == 0);
  }
  /// Whether bodies may be disabled or fail: the world's file says that some do, or its spec says that it is
  /// mortal. Only then does the world have the component `condition`.
  bool has_conditions() const { return condition_table_.has_value(); }
  /// Disables or enables a body, between steps, as `at` does. Returns false and changes nothing if it is so
  /// already or is not in the world. Throws std::logic_error in a world without conditions.
  bool set_disabled(Row row, bool disabled);
  /// Number of rows whose bodies are disabled or otherwise impaired.
  std::size_t impaired_count() const { return impaired_; }

  /// A row and a pose for its body.
  struct Placed {
    Row row;    ///< of the body
    Pose pose;  ///< world frame; the heading is wrapped
  };
  /// Sets poses of bodies, between steps; if a row occurs twice, its last pose counts. Odometry does not
  /// register it, velocities stay, and stalled robots are no longer stalled. The poses need not be free:
  /// bodies that overlap may move apart but not closer, as after overlaps at tick 0. Carried bodies move with
  /// their carriers. Throws std::invalid_argument, and moves no body, if a body is carried or not in the
  /// world, or a pose is not finite or out of bounds. Each call rebuilds the index of all bodies, so it is
  /// best given all poses at once.
  void set_poses(std::span<const Placed> placed);
  /// Bodies whose poses were set between the last step and the one before it, and bodies that they carried,
  /// each with its pose when the last step began: for measures of distance travelled. Not state.
  std::span<const Placed> placed_before_step() const { return placed_before_; }
  /// Whether a body at this pose would be within the world's bounds and overlap no obstacle.
  bool is_free(Row row, const Pose& pose) const;
  /// Percepts of one sensor of a type, one row per slot.
  const StateTable& percepts(const BodyType::Device& sensor) const { return tables_[sensor.table]; }
  /// Runs every sensor of this body; to be called before the first step.
  void subscribe(BodyId body) { row_subscribed_[row(body).index()] = 1; }
  /// Bodies for which subscribe() was called, in order of ids.
  std::vector<BodyId> subscribed() const;
  /// Whether a sensor of the row is active or subscribed to.
  bool senses(Row row, const BodyType::Device& sensor) const {
    return sensor.active || row_subscribed_[row.index()] != 0;
  }
  /// Whether the supply of the row's device or drive is not spent; true if it needs no supply.
  bool is_supplied(Row row, std::optional<std::size_t> supply) const {
    if (!supply) return true;
    const BodyType::Device& device = type(row).devices[*supply];
    return !device.kind->is_spent(device.prepared.data, tables_[device.table], slot(row));
  }
  /// Whether the row's device has not been switched off.
  bool is_on(Row row, const BodyType::Device& device) const {
    return device.switch_bit == 0 || (commands()[row.index()].off & device.switch_bit) == 0;
  }
  /// Whether a device runs in the ticks of its period: it is active or subscribed to, is switched on, works,
  /// and its supply is not spent.
  bool runs(Row row, const BodyType::Device& device) const {
    return senses(row, device) && is_on(row, device) && works(row, device) && is_supplied(row, device.supply);
  }
  /// Commands of a device that takes commands, one row per slot; may be changed between steps.
  StateTable& asked_of(const BodyType::Device& device) { return tables_[*device.command_table]; }
  /// State of a device; may be changed by effects (DeviceKind::apply) and between steps.
  StateTable& state(const BodyType::Device& device) { return tables_[device.table]; }
  /// Vertices of a row's outlines, world frame, in the order of BodyType::outline_vertices.
  std::span<const Vec2> outline(Row row) const {
    return {outlines_.data() + outline_begins_[row.index()], type(row).outline_vertices.size()};
  }
  /// Contribution of a table to the hash of the state: the sum over its rows.
  std::uint64_t hash(const StateTable& table);
  Hashes hashes();  ///< of the present state; runs on the workers

  // ---- counters
  std::uint64_t beams_cast() const { return beams_; }  ///< rays cast by all sensors since tick 0
  /// Number of robots whose last motion was blocked or would have ended out of bounds.
  std::size_t stalled_count() const { return stalled_; }
  /// Number of robots whose last motion would have ended out of bounds.
  std::size_t out_of_bounds_count() const { return out_of_bounds_; }
  /// Rounds of conflict resolution since tick 0, see Conflicts::rounds().
  std::uint64_t conflict_rounds() const { return conflict_rounds_; }
  /// Mean straight-line distance of the robots in the world from their origin(), m; 0 without robots.
  double mean_displacement() const;

  // ---- for viewers
  FrameScene frame_scene() const;  ///< constants for renderers: engine/frame.hpp
  Frame frame() const;             ///< state of this tick for renderers

 private:
  enum TableIndex : std::size_t { k_pose, k_velocity, k_command, k_stall };
  enum Stall : std::uint8_t { k_free, k_blocked, k_out_of_bounds };

  template <class T>
  std::span<T> as(std::size_t table) {
    return {reinterpret_cast<T*>(tables_[table].row(0)), tables_[table].rows()};
  }
  template <class T>
  std::span<const T> as(std::size_t table) const {
    return {reinterpret_cast<const T*>(tables_[table].row(0)), tables_[table].rows()};
  }

  std::span<std::uint8_t> stall() { return tables_[k_stall].column<std::uint8_t>(0); }
  std::span<const std::uint8_t> stall() const { return tables_[k_stall].column<std::uint8_t>(0); }

  [[noreturn]] void throw_half_made() const;
  /// Guard of a step: the state is incomplete if the guarded work throws, and complete otherwise.
  class Completion {
   public:
    explicit Completion(World& world) : world_(world) { world_.is_half_made_ = false; }
    ~Completion() { world_.is_half_made_ = std::uncaught_exceptions() > before_; }
    Completion(const Completion&) = delete;
    Completion& operator=(const Completion&) = delete;

   private:
    World& world_;
    int before_ = std::uncaught_exceptions();
  };
  void check_size(Diagnostics& diagnostics) const;
  void check_reserves(Diagnostics& diagnostics) const;
  std::vector<BodyId> rows_by_place() const;
  void build_rows();
  void build_pushables();
  void build_scene();
  void build_tables();
  void build_lives();
  /// Fills the tables with the state at tick 0, and derives the rest.
  void start();
  /// Draws the odometry error of each robot.
  void draw_odometry_errors();
  /// Sets the state of a row to that at birth. Its bytes must be 0.
  void start(Row row, const Pose& pose);
  void start(Row row, const BodyType::Drive& drive);
  /// Makes everything that is neither constant, nor state, nor set by the program. Reads only the spec, the
  /// tick and the tables, never earlier derived data. Called after every start, reset and restore.
  void derive();
  /// The part of derive() for one row; also called for bodies that are born or die.
  void derive(Row row);
  void build_ray_grid(Diagnostics& diagnostics);
  void report_overlaps(Diagnostics& diagnostics);
  /// Box in which motions must end.
  Box bounds() const;
  void count_stalls();

  void sense();
  void actuate();
  void decide();
  DeviceBatch device_batch(std::span<const Row> rows, const BodyType& type, const BodyType::Device& sensor);
  void drive(std::span<const Row> rows, const BodyType::Drive& drive, std::atomic<std::uint32_t>& faulty);
  void halt_disabled(std::span<const Row> rows);
  void halt_spent(std::span<const Row> rows, const BodyType::Drive& drive);
  void decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller);
  void move();
  void propose();
  void commit();
  /// Advances the odometry of a robot that has moved as proposed.
  void count_way(Row row, const BodyType::Drive& drive);
  void commit_pushes();
  void apply_effects();

  // engine/lives.cpp
  /// A row of the component `life`: all zero for bodies present at tick 0.
  struct Life {
    std::uint64_t birth = 0;
    double x = 0;
    double y = 0;
    std::uint8_t presence = 0;
  };
  Life& life(Row row) { return tables_[*life_table_].as<Life>(row.index()); }
  void derive_lives();
  bool lives_hold(std::uint64_t tick) const;
  /// Sets obstacle shape and radius of a row, for conflicts and queries: those of its type, or empty ones if
  /// its body is absent.
  void update_presence(Row row);
  /// Sets every byte of the row's state to 0.
  void clear(Row row);
  Birth give_birth(std::size_t reserve, const Pose& pose);
  void die(Row row);
  void resolve_lives(std::span<const Effect> effects);

  // engine/experiment.cpp
  void build_experiment(const Registry& registry, Diagnostics& diagnostics);
  /// types: the types that earlier settings changed, with these changes.
  void build_intervention(Experiment::Intervention& intervention, const Registry& registry,
                          std::map<std::uint32_t, TypeSpec>& types, Diagnostics& diagnostics);
  /// Returns an error that says what is wrong with the setting.
  Result<> build_setting(const SettingSpec& setting, const Registry& registry,
                         std::map<std::uint32_t, TypeSpec>& types, Experiment::Intervention& intervention);
  void build_faults(const Registry& registry, Diagnostics& diagnostics);
  void build_fault(std::size_t at, const Registry& registry, Diagnostics& diagnostics);
  void build_conditions();
  /// Rows of a group, in order of ids; empty, with an error reported, if no body has the group's name.
  std::vector<Row> rows_of(const GroupSpec& group, Where where, Diagnostics& diagnostics) const;
  /// Derives which interventions are done: all that were due before the last tick ended, none that are due
  /// now.
  void derive_experiment();
  void find_due();
  bool conditions_hold() const;
  void count_impaired();
  void intervene();
  bool carry_out(Experiment::Intervention& intervention);
  void toggle_disabled(Row row);
  /// As many of the candidates as the group asks for, in order of ids.
  std::span<const Experiment::Candidate> choose(const GroupSpec& group);
  bool add(const Experiment::Intervention& intervention);
  Pose place_to_add(const Experiment::Intervention& intervention, std::uint32_t number,
                    std::uint32_t trial) const;
  bool is_setting(const Experiment::Intervention& intervention) const;
  void swap_setting(Experiment::Intervention& intervention);
  std::uint64_t next_fault_tick(std::uint32_t fault, BodyId body, std::uint64_t from) const;
  Experiment::FaultEvent take_fault_event();
  void apply_fault_event(const Experiment::FaultEvent& event);
  const Condition& condition(Row row) const { return tables_[*condition_table_].as<Condition>(row.index()); }
  Condition& condition(Row row) { return tables_[*condition_table_].as<Condition>(row.index()); }
  double speed_scale(Row row) const;

  // engine/links.cpp
  struct TreeBody;
  void build_links();
  void derive_links();
  void forget_links();
  bool links_hold() const;
  std::span<Links::Joint> joints(Row row);
  std::span<const Links::Joint> joints(Row row) const;
  Pose& joint_state(Row row, std::size_t joint);
  void rest_joints(Row row);
  void move_to_joints(Row row);
  void link_cargo(std::uint32_t cargo, std::uint32_t carrier);
  void unlink_cargo(std::uint32_t cargo, std::uint32_t carrier);
  void set_root(std::uint32_t row, std::uint32_t root);
  void add_tree_body(const TreeBody& body, bool then, ShapeBuffer& out, double& thinnest) const;
  void reshape(std::uint32_t row);
  void update_jointed_outlines(Row row, const BodyType& type, const Transform& transform);
  void resolve_joints();
  void report_joints();
  double aim_joints(const TreeBody& body, std::size_t round, double t, double radius);
  double ask_joints(std::size_t c, Row root, std::size_t round);
  bool refuses_joints(std::size_t c, Row root, std::size_t round, double reach);
  bool others_refuse(Row root, const partition::PlacedShape& before, const partition::PlacedShape& after,
                     double reach) const;
  void answer_joints(Row row, std::size_t round, bool refused);
  void carry();
  void redraw_ray_grid();
  void carry_cargo_of(Row carrier);
  template <class Work>
  void for_roots(Work&& work);

  void remember_placed(Row row);
  void begin_placing();
  /// Sets what is derived from a row's pose: its transform and the vertices of its outlines.
  void update_outlines(Row row, const BodyType& type, const Transform& transform);
  void index_bodies();
  FrameType look_of(std::size_t t, Row row) const;
  void begin(Phase phase);
  /// Calls work(rows of one type, type) in parallel, with rows that are near one another in the world: for
  /// work that reads neighbours.
  template <class Work>
  void for_neighbours(Work&& work);
  /// Calls work(rows of one type, type) in parallel, with consecutive rows, which are read sequentially: for
  /// work that does not read neighbours.
  template <class Work>
  void for_blocks(Work&& work);
  template <class Work>
  void for_types(std::span<Row> rows, Work&& work);
  template <class Work>
  void for_enabled(std::span<const Row> rows, Work&& work);
  template <class Work>
  void for_due(std::span<const Row> rows, std::uint64_t period, Work&& work);
  template <class Work>
  void for_running(std::span<const Row> rows, const BodyType::Device& device, Work&& work);

  // Every member is constant, state, set by the program, derived, or scratch. Only state is saved, so no
  // other member may carry information from one tick to the next.

  // Constants: made from the spec by the constructor.
  WorldSpec spec_;
  std::vector<BodyType> types_;  // except parameters that settings swap: see derive()
  partition::Parallel parallel_;
  partition::GridGeometry geometry_;
  partition::StaticScene scene_;
  FixedTargets fixed_targets_;
  mutable NameMap names_;  // built by the first find(), because most runs never call it
  mutable std::once_flag names_made_;
  std::vector<BodyId> row_bodies_;
  std::vector<Row> body_rows_;
  std::vector<std::uint32_t> row_types_;
  std::vector<std::uint32_t> row_slots_;
  std::vector<std::uint32_t> row_ids_;
  std::vector<std::uint8_t> row_pushable_;  // this and row_push_limits_: empty if nothing can be pushed
  std::vector<std::uint8_t> row_push_limits_;
  Pushables pushables_;
  std::vector<std::size_t> outline_begins_;
  std::vector<Localization::Error> row_odometry_errors_;  // empty if no robot has odometry
  std::size_t robots_at_start_ = 0;
  std::optional<std::size_t> carrier_table_;
  std::optional<std::size_t> life_table_;
  std::optional<std::size_t> condition_table_;

  // State, and counters.
  std::uint64_t tick_ = 0;
  std::vector<StateTable> tables_;
  bool is_half_made_ = false;  // a step threw: only reset(), restart() and restore() are allowed
  std::uint64_t beams_ = 0;
  std::uint64_t conflict_rounds_ = 0;

  // Set by the program.
  std::vector<std::uint8_t> row_subscribed_;  // in addition to the active sensors
  std::function<void(std::optional<Phase>)> on_phase_;
  OnDecide on_decide_;
  std::function<void()> before_tick_;

  // Derived: made by derive(), kept up to date by each tick.
  std::vector<Transform> transforms_;
  std::vector<Vec2> outlines_;
  std::vector<double> row_radii_;
  std::vector<const partition::ObstacleShape*> row_shapes_;
  std::vector<FreeCircle> free_circles_;
  std::vector<std::uint8_t> not_drawn_;   // by the grid ray engine, one entry per row; empty without lives
  std::vector<std::uint32_t> next_born_;  // of each reserve: position of its first unborn body
  std::vector<Row> newborn_;              // rows that the index does not contain yet
  std::size_t robots_ = 0;
  std::size_t absent_ = 0;
  std::size_t impaired_ = 0;
  std::size_t stalled_ = 0;
  std::size_t out_of_bounds_ = 0;
  Links links_;            // except its lists of composite bodies, which are constant
  Experiment experiment_;  // except its lists of interventions and faults, which are constant
  partition::BodyIndex index_;
  std::unique_ptr<partition::RayGrid> ray_grid_;

  // Scratch: of the current tick, and for measures.
  std::vector<Motion> motions_;  // absent bodies never propose one
  Conflicts conflicts_;
  Effects effects_;
  std::vector<Placed> placed_;            // set since the last step, each row once
  std::vector<Placed> placed_before_;     // set between the last two steps
  std::vector<std::uint32_t> placed_at_;  // position of each row in placed_, from 1; 0: not in it
};

}  // namespace troupe::engine
