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

// engine/frame.hpp, for those who look.
struct Frame;
struct FrameScene;
struct FrameType;

/// What a run is given beside its world. Nothing here changes a result.
struct WorldOptions {
  unsigned threads = 0;    ///< 0: one for each processor that it may use; see partition::Parallel
  double tile_size_m = 0;  ///< 0: chosen from body sizes and sensor ranges
};

/// A step cannot be completed: a value is no number, or a function of a kind threw. The text names the tick
/// and the robot.
class StepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The hash of a state (docs/determinism.md) and what it is the sum of, modulo 2^64.
struct Hashes {
  std::uint64_t state = 0;                            ///< of all tables
  std::array<std::uint64_t, k_hash_groups> groups{};  ///< by HashGroup
};

/// Whether a body is in the world.
enum class Presence : std::uint8_t {
  there,   ///< it is
  unborn,  ///< it waits in a reserve
  dead,    ///< its life is over; it does not come back
};

/// A world that runs: constants made from a WorldSpec, the state tables, and the tick.
///
/// S(k+1) = step(S(k)) is a pure function: of the state, the spec and the seed, and of nothing else.
class World {
 public:
  /// Throws InputError for what a loader could not see (kinds without their sensors, ...); warns of overlaps
  /// at the start, once, with a count, up to 10,000 pairs; of each of the first hundred where thorough.
  /// The registry must outlive the world.
  World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics);
  World(WorldSpec, Registry&&, const WorldOptions&, Diagnostics&) = delete;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // ---- the tick: engine/step.cpp
  /// From S(k) to S(k+1). Throws StepError where a value is no number and where a function of a kind throws,
  /// and whatever a callback of on_phase() throws; then the state is half made, see require_whole().
  /// Allocates nothing once warm.
  void step();
  /// Throws std::logic_error from the time that a step threw until reset() or restore(): the state is then
  /// that of no tick. Whatever reads the state as a whole or continues it calls this first: step(), hashes(),
  /// tables(), frame(), spawn(), remove() and the set_ functions; single rows are given without asking.
  void require_whole() const {
    if (is_half_made_) throw_half_made();
  }
  /// Back to S(0): every table, the tick, the counters and whatever is derived from them, as the constructor
  /// left them. What the program itself set, callbacks and subscriptions, stays. Allocates nothing. Also
  /// after a step that threw.
  void reset();
  /// To S(0) of the same world with another seed: what the constructor makes of a spec with this seed and
  /// these bodies, but for the order in which rows are stored, which changes no result. What the program set
  /// stays, as in reset(). Runs and draws as a new world does, also after a step that threw.
  /// bodies: one for each body of the spec, of the same names and types; poses and colours may differ. Where
  /// a body that never moves stands elsewhere the static scene is built again.
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry);
  /// What a run has counted up to a tick, beside its state.
  struct Counters {
    std::uint64_t beams = 0;            ///< rays cast by all sensors
    std::uint64_t conflict_rounds = 0;  ///< rounds of settling, see Conflicts::rounds()
  };
  Counters counters() const { return {beams_, conflict_rounds_}; }  ///< of this run so far
  /// Finds every byte of the tables 0, and sets every field of every row.
  using Fill = std::function<void(std::span<StateTable>)>;
  /// Goes to a saved state of a later tick; what is derived from the tables is derived again.
  /// False where the state then has not this hash, or a body stands nowhere: the world is at S(0) again, as
  /// it is when `fill` throws.
  bool restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash, const Fill& fill);
  /// Overwrites with junk whatever is neither a constant, nor state, nor set by the program, and derives it
  /// again. The run goes on with the same bits: this is what tests that ("amnesia", docs/determinism.md).
  void forget();
  std::uint64_t tick() const { return tick_; }    ///< ticks done; 0 at the start
  double tick_s() const { return spec_.tick_s; }  ///< length of a tick, s
  /// World time: tick() * tick_s().
  double time_s() const { return static_cast<double>(tick_) * spec_.tick_s; }
  /// Called as each phase begins, and with no phase as the tick ends.
  void on_phase(std::function<void(std::optional<Phase>)> callback) { on_phase_ = std::move(callback); }
  /// Called in each step when what the world's file asks for (`at`, faults) has been done, before the tick
  /// begins: it may do to the world what a program does between two steps. What it throws comes out of
  /// step(). Replaces the callback; set between steps.
  void before_tick(std::function<void()> callback) { before_tick_ = std::move(callback); }
  /// Called on its worker where a batch of robots is to decide, and must have them do it:
  /// controller.kind->decide(controller.data, batch). On several workers at once, so it must be thread-safe.
  /// For checks of controllers; set between steps.
  using OnDecide =
      std::function<void(const BodyType& type, const BodyType::Controller& controller, const DecideBatch&)>;
  /// Replaces the callback; an empty one has every batch decide as ever.
  void on_decide(OnDecide callback) { on_decide_ = std::move(callback); }

  // ---- what it is made of
  const WorldSpec& spec() const { return spec_; }                 ///< what it was built from
  std::span<const BodyType> types() const { return types_; }      ///< by TypeId
  const partition::StaticScene& scene() const { return scene_; }  ///< static bodies
  /// Where the rows are now; of the end of the last step.
  const partition::BodyIndex& index() const { return index_; }
  /// What of the static scene fiducial finders find.
  const FixedTargets& fixed_targets() const { return fixed_targets_; }
  /// What the grid engine's rays walk through; null where the world asks for the exact engine.
  const partition::RayGrid* ray_grid() const { return ray_grid_.get(); }
  /// The sparse grid's cells and tiles; no result depends on them.
  const partition::GridGeometry& geometry() const { return geometry_; }
  /// The workers that the step runs on, for who measures between steps.
  partition::Parallel& parallel() { return parallel_; }
  /// Rows: the bodies that can move, sense or decide, by where they stand at tick 0.
  std::size_t rows() const { return row_bodies_.size(); }
  /// Robots: the rows that have a drive. How many there are at tick 0, and now.
  std::size_t robots_at_start() const { return robots_at_start_; }
  /// How many of them are there now.
  std::size_t robots() const { return robots_; }
  BodyId body(Row row) const { return row_bodies_[row.index()]; }  ///< whose row it is
  /// Not valid for bodies that never change.
  Row row(BodyId body) const { return body_rows_[body.index()]; }
  const BodyType& type(Row row) const { return types_[row_types_[row.index()]]; }  ///< of the row's body
  /// Position of a row among those of its type: its row in the type's tables.
  std::size_t slot(Row row) const { return row_slots_[row.index()]; }
  /// Body id by name or alias; not valid when there is none. Of equal names the last body has it. From any
  /// thread.
  BodyId find(std::string_view name) const;

  // ---- the state
  /// One a component; BodyType names them by their index here.
  std::span<const StateTable> tables() const {
    require_whole();
    return tables_;
  }
  /// World frame, a row each; of the dead where they died.
  std::span<const Pose> poses() const { return as<Pose>(k_pose); }
  Pose pose(BodyId body) const;  ///< of any body, also one that never moves, world frame
  /// That of the row's pose, its sine and cosine worked out once a tick: the same bits as Transform(pose).
  const Transform& transform(Row row) const { return transforms_[row.index()]; }
  /// Body frame, a row each: what the drive gives, also where the motion was refused.
  std::span<const Velocity> velocities() const { return as<Velocity>(k_velocity); }
  /// Of the body's own drive, a row each.
  std::span<const Command> commands() const { return as<Command>(k_command); }
  /// Whether its last motion was refused or would have left the world; and whether the latter.
  bool stalled(Row row) const;
  /// Whether its last motion would have left the world's bounds.
  bool held(Row row) const;
  /// Estimated pose of a robot: engine/localization.hpp.
  Pose estimate(Row row) const { return estimates(type(row)).of(row, slot(row)); }
  Estimates estimates(const BodyType& type) const;  ///< of all robots of a type
  /// Overwrites the odometry estimate of a robot. Throws std::logic_error if the robot has no odometry.
  void set_estimate(Row row, const Pose& pose);
  /// Commands a robot from outside, between steps.
  void set_command(Row row, const Command& command) {
    require_whole();
    tables_[k_command].as<Command>(row.index()) = command;
  }
  /// Where the body's frame is as seen from what stands on a joint of its type: the row's pose, but for what
  /// the joint moves. What the type says of parts and devices on that joint is said in this frame.
  Mount mount(Row row, std::int32_t joint) const;
  /// No surface of the row's body is farther from its origin, with its joints as they are, m.
  double radius(Row row) const { return row_radii_[row.index()]; }
  /// By how much that joint has raised what stands on it, m.
  double lift(Row row, std::int32_t joint) const {
    return joint == k_rigid
               ? 0.0
               : links_.joints[links_.joint_begins[row.index()] + static_cast<std::size_t>(joint)].now.z;
  }
  /// Where a joint is, relative to its rest.
  const Pose& joint_state(Row row, std::size_t joint) const;
  /// The body that carries it; none where it is not carried.
  std::optional<BodyId> carrier(Row row) const;
  /// How many are carried.
  std::size_t carried_count() const { return links_.carried; }
  /// Whether two bodies move as one, because one carries the other or a third carries both.
  bool same_tree(Row a, Row b) const {
    return a == b || (links_.carried > 0 && links_.roots[a.index()] == links_.roots[b.index()]);
  }
  /// From now on a body moves with another, or with a joint of it, as it stands to it now. False, and nothing
  /// is changed, where it is carried already, carries the other itself, or the other cannot carry anything.
  /// As release(), for DeviceKind::apply.
  bool attach(Row cargo, Row carrier, std::int32_t joint);
  /// Leaves a body where it is, to itself.
  void release(Row cargo);

  // ---- births and deaths: engine/lives.cpp
  /// Whether bodies may come and go here: the world has reserves, something in it ends lives, or its spec
  /// says that it is mortal. Only then has it the component `life`.
  bool has_lives() const { return life_table_.has_value(); }
  /// Of the row's body; without lives always there.
  Presence presence(Row row) const {
    return life_table_ ? static_cast<Presence>(tables_[*life_table_].as<Life>(row.index()).presence)
                       : Presence::there;
  }
  /// Who is not there is not indexed, senses nothing, decides nothing and does not move; its rows are 0, but
  /// for where it died.
  bool is_there(Row row) const { return absent_ == 0 || presence(row) == Presence::there; }
  /// Rows whose bodies are not there.
  std::size_t absent_count() const { return absent_; }
  /// Where its life began, at tick 0 or later, m, world frame.
  Vec2 origin(Row row) const;
  /// The tick after which its life began. Whatever runs with a period counts from there.
  std::uint64_t birth_tick(Row row) const {
    return life_table_ ? tables_[*life_table_].as<Life>(row.index()).birth : 0;
  }
  /// The reserve of this population: index into WorldSpec::reserves.
  std::optional<std::size_t> reserve(std::string_view population) const;
  /// Who of it is still to be born.
  std::size_t unborn(std::size_t reserve) const {
    return spec_.reserves[reserve].count - next_born_[reserve];
  }
  /// Bears the next body of a reserve, between steps, at a pose where it touches nothing solid: its life
  /// begins as that of others at tick 0. Throws std::invalid_argument for a pose that is not finite. Indexes
  /// all bodies again.
  Birth spawn(std::size_t reserve, const Pose& pose);
  /// Ends a life, between steps: what the body carries stays where it is, and so does what it was. Does
  /// nothing to a body that is not there. Throws std::logic_error where no body may be born or die. Indexes
  /// all bodies again.
  void remove(Row row);

  // ---- experiments: engine/experiment.cpp
  /// Whether all of the row's body has stopped, because it was disabled or a fault has it drop out: devices,
  /// controllers and drive. It stands where it is, and is met and seen.
  bool is_out(Row row) const { return ailing_ > 0 && condition(row).out != 0; }
  /// Whether nothing keeps the row's device from working: see Condition.
  bool works(Row row, const BodyType::Device& device) const {
    if (ailing_ == 0) return true;
    const Condition& now = condition(row);
    const auto d = static_cast<std::size_t>(&device - type(row).devices.data());
    return now.out == 0 && (d >= k_most_fallible || (now.dead >> d & 1) == 0);
  }
  /// Whether bodies may be disabled or fail here: the world's file says that some do, or its spec says that
  /// it is mortal. Only then has the world the component `condition`.
  bool has_conditions() const { return condition_table_.has_value(); }
  /// Disables a body, or enables it again, between steps, as `at` does. False, and nothing is changed, where
  /// it is so already, or is not there. Throws std::logic_error in a world without conditions.
  bool set_disabled(Row row, bool disabled);
  /// Rows that are not sound.
  std::size_t ailing_count() const { return ailing_; }

  /// A body, and where it stands or is to stand.
  struct Placed {
    Row row;    ///< who
    Pose pose;  ///< world frame; the heading is wrapped
  };
  /// Puts bodies elsewhere, between steps; of a row that is named twice the last pose counts. That is no
  /// motion: odometry does not see it, speeds stay, and stalled robots no longer are. The place is not
  /// checked: bodies that overlap there may move apart, but not closer, as bodies that overlap at the start.
  /// What a body carries goes with it. Throws std::invalid_argument, and moves no body, for a body that is
  /// carried or not there, and for a pose that is not finite or not within the world's bounds. Each call
  /// indexes all bodies again: move many at once.
  void set_poses(std::span<const Placed> placed);
  /// Who was put elsewhere between the last step and the one before it, with all that was carried along, and
  /// where each stood when the last step began: for who counts ways. No state.
  std::span<const Placed> placed_before_step() const { return placed_before_; }
  /// Whether a body would stand at this pose within the world's bounds and free of everything solid.
  bool is_free(Row row, const Pose& pose) const;
  /// Percepts of one sensor of a type.
  const StateTable& percepts(const BodyType::Device& sensor) const { return tables_[sensor.table]; }
  /// Runs every sensor of this body from now on; before the first step.
  void subscribe(BodyId body) { row_subscribed_[row(body).index()] = 1; }
  /// The bodies that subscribe() was called for, by id.
  std::vector<BodyId> subscribed() const;
  /// Whether a sensor of the row's type runs for this row.
  bool senses(Row row, const BodyType::Device& sensor) const {
    return sensor.active || row_subscribed_[row.index()] != 0;
  }
  /// Whether what the row's device, or drive, runs on has something left; true where it runs on nothing.
  bool is_supplied(Row row, std::optional<std::size_t> supply) const {
    if (!supply) return true;
    const BodyType::Device& device = type(row).devices[*supply];
    return !device.kind->is_spent(device.prepared.data, tables_[device.table], slot(row));
  }
  /// Whether the row's device has not been switched off.
  bool is_on(Row row, const BodyType::Device& device) const {
    return device.switch_bit == 0 || (commands()[row.index()].off & device.switch_bit) == 0;
  }
  /// Whether it runs when it is due: it is read or subscribed to, is on, works, and its supply is not spent.
  bool runs(Row row, const BodyType::Device& device) const {
    return senses(row, device) && is_on(row, device) && works(row, device) && is_supplied(row, device.supply);
  }
  /// What is asked of a device that takes commands, a row a slot, from outside, between steps.
  StateTable& asked_of(const BodyType::Device& device) { return tables_[*device.command_table]; }
  /// The state of a device, to be changed by effects (DeviceKind::apply) and between steps.
  StateTable& state(const BodyType::Device& device) { return tables_[device.table]; }
  /// Vertices of a row's outlines in the world's frame, in the order of its type's.
  std::span<const Vec2> outline(Row row) const {
    return {outlines_.data() + outline_begins_[row.index()], type(row).outline_vertices.size()};
  }
  /// What one table adds to the hash of the state: the sum over its rows.
  std::uint64_t hash(const StateTable& table);
  Hashes hashes();  ///< of the state as it is; runs on the workers

  // ---- counters
  std::uint64_t beams_cast() const { return beams_; }  ///< by all sensors since tick 0
  /// Robots whose last motion was refused or would have left the world, and those of the latter.
  std::size_t stalled_count() const { return stalled_; }
  /// Those of them whose motion would have left the world.
  std::size_t held_count() const { return held_; }
  /// Since tick 0, see Conflicts::rounds().
  std::uint64_t conflict_rounds() const { return conflict_rounds_; }
  /// Of the robots that are there, from origin() in a straight line, m; 0 where there is none.
  double mean_displacement() const;

  // ---- for viewers
  FrameScene frame_scene() const;  ///< what pictures need once: engine/frame.hpp
  Frame frame() const;             ///< what pictures need of this tick

 private:
  enum TableIndex : std::size_t { k_pose, k_velocity, k_command, k_stall };
  enum Stall : std::uint8_t { k_free, k_refused, k_held };

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
  /// The state is half made where the work that one of these guards throws, and whole where it ends.
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
  /// Fills the tables with the state that the spec describes, and derives the rest.
  void start();
  /// How wrong the odometry of each robot is.
  void draw_odometry_errors();
  /// Begins a life, in rows that are all 0.
  void start(Row row, const Pose& pose);
  void start(Row row, const BodyType::Drive& drive);
  /// Makes everything that is neither a constant, nor state, nor set by the program, from spec, tick and
  /// tables, and from nothing else: after every start, reset and restore, whatever was there before.
  void derive();
  /// The part of derive() that is about one row. Births and deaths call it for theirs.
  void derive(Row row);
  void build_ray_grid(Diagnostics& diagnostics);
  void report_overlaps(Diagnostics& diagnostics);
  /// Where motions may end.
  Box bounds() const;
  void count_stalls();

  void sense();
  void decide();
  DeviceBatch device_batch(std::span<const Row> rows, const BodyType& type, const BodyType::Device& sensor);
  void drive(std::span<const Row> rows, const BodyType::Drive& drive, std::atomic<std::uint32_t>& faulty);
  void halt_spent(std::span<const Row> rows, const BodyType::Drive& drive);
  void decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller);
  void move();
  void propose();
  void commit();
  /// The odometry of a robot that has moved as proposed.
  void count_way(Row row, const BodyType::Drive& drive);
  void commit_pushes();
  void apply_effects();

  // engine/lives.cpp
  /// A row of the component `life`: all zero for who is there from the start.
  struct Life {
    std::uint64_t birth = 0;
    double x = 0;
    double y = 0;
    std::uint8_t presence = 0;
  };
  Life& life(Row row) { return tables_[*life_table_].as<Life>(row.index()); }
  void derive_lives();
  bool lives_hold(std::uint64_t tick) const;
  /// Fits what conflicts and queries know of a row to whether its body is there.
  void show(Row row);
  /// Sets every byte of its state to 0.
  void clear(Row row);
  Birth bear(std::size_t reserve, const Pose& pose);
  void die(Row row);
  void settle_lives(std::span<const Effect> effects);

  // engine/experiment.cpp
  void build_experiment(const Registry& registry, Diagnostics& diagnostics);
  /// types: those that settings have changed so far, as they are then.
  void build_intervention(Experiment::Intervention& intervention, const Registry& registry,
                          std::map<std::uint32_t, TypeSpec>& types, Diagnostics& diagnostics);
  /// Or says what is wrong with it.
  Result<> build_setting(const SettingSpec& setting, const Registry& registry,
                         std::map<std::uint32_t, TypeSpec>& types, Experiment::Intervention& intervention);
  void build_faults(const Registry& registry, Diagnostics& diagnostics);
  void build_fault(std::size_t at, const Registry& registry, Diagnostics& diagnostics);
  void build_conditions();
  /// By id; none, and an error, where no body has that name.
  std::vector<Row> rows_of(const GroupSpec& group, Where where, Diagnostics& diagnostics) const;
  /// What was to be done before the last tick had ended is done, and what is to be done now is not.
  void derive_experiment();
  void find_due();
  bool conditions_hold() const;
  void count_ailing();
  void intervene();
  bool carry_out(Experiment::Intervention& intervention);
  void toggle_disabled(Row row);
  /// Of the candidates as many as the group asks for, by id.
  std::span<const Experiment::Candidate> choose(const GroupSpec& group);
  bool add(const Experiment::Intervention& intervention);
  Pose place_to_add(const Experiment::Intervention& intervention, std::uint32_t number,
                    std::uint32_t trial) const;
  bool is_setting(const Experiment::Intervention& intervention) const;
  void swap_setting(Experiment::Intervention& intervention);
  std::uint64_t next_strike(std::uint32_t fault, BodyId body, std::uint64_t from) const;
  Experiment::Strike take_strike();
  void befall(const Experiment::Strike& strike);
  const Condition& condition(Row row) const { return tables_[*condition_table_].as<Condition>(row.index()); }
  Condition& condition(Row row) { return tables_[*condition_table_].as<Condition>(row.index()); }
  double slowness(Row row) const;
  std::span<const Row> halt_those_out(std::span<const Row> rows, std::span<Row> others);

  // engine/links.cpp
  struct Limb;
  void build_links();
  void derive_links();
  void forget_links();
  bool links_hold() const;
  std::span<Links::Joint> joints(Row row);
  std::span<const Links::Joint> joints(Row row) const;
  Pose& joint_state(Row row, std::size_t joint);
  void rest_joints(Row row);
  void move_to_joints(Row row);
  void hang(std::uint32_t cargo, std::uint32_t carrier);
  void unhang(std::uint32_t cargo, std::uint32_t carrier);
  void set_root(std::uint32_t row, std::uint32_t root);
  void add_limb(const Limb& limb, bool then, ShapeBuffer& out, double& thinnest) const;
  void reshape(std::uint32_t row);
  void put_outlines(Row row, const BodyType& type, const Transform& transform);
  void settle_joints();
  void report_joints();
  double aim_joints(const Limb& limb, std::size_t round, double t, double radius);
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
  /// What is derived from a row's pose.
  void put(Row row, const BodyType& type, const Transform& transform);
  void index_bodies();
  FrameType look_of(std::size_t t, Row row) const;
  void begin(Phase phase);
  /// work(rows of one type, type), in parallel. Where rows look at one another: of rows that lie near one
  /// another in the world.
  template <class Work>
  void for_neighbours(Work&& work);
  /// Where they do not: of rows that lie near one another in memory, which is read in one go.
  template <class Work>
  void for_blocks(Work&& work);
  template <class Work>
  void for_types(std::span<Row> rows, Work&& work);
  template <class Work>
  void for_due(std::span<const Row> rows, std::uint64_t period, Work&& work);
  template <class Work>
  void for_running(std::span<const Row> rows, const BodyType::Device& device, Work&& work);

  // Every member is one of five: a constant, state, set by the program, derived, or scratch. Only state is
  // saved, so nothing else may carry anything from one tick to the next.

  // Constants: made from the spec by the constructor.
  WorldSpec spec_;
  std::vector<BodyType> types_;  // but for the parameters that settings swap: see derive()
  partition::Parallel parallel_;
  partition::GridGeometry geometry_;
  partition::StaticScene scene_;
  FixedTargets fixed_targets_;
  mutable NameMap names_;  // made at the first find(), which most runs never call
  mutable std::once_flag names_made_;
  std::vector<BodyId> row_bodies_;
  std::vector<Row> body_rows_;
  std::vector<std::uint32_t> row_types_;
  std::vector<std::uint32_t> row_slots_;
  std::vector<std::uint32_t> row_ids_;
  std::vector<std::uint8_t> row_pushable_;  // these two empty where nothing can be pushed
  std::vector<std::uint8_t> row_push_limits_;
  Pushables pushables_;
  std::vector<std::size_t> outline_begins_;
  std::vector<Localization::Error> row_odometry_errors_;  // empty where no robot has odometry
  std::size_t robots_at_start_ = 0;
  std::optional<std::size_t> carrier_table_;
  std::optional<std::size_t> life_table_;
  std::optional<std::size_t> condition_table_;

  // State, and what is counted beside it.
  std::uint64_t tick_ = 0;
  std::vector<StateTable> tables_;
  bool is_half_made_ = false;  // a step threw: only reset() and restore() lead on
  std::uint64_t beams_ = 0;
  std::uint64_t conflict_rounds_ = 0;

  // Set by the program.
  std::vector<std::uint8_t> row_subscribed_;  // beside what the world runs
  std::function<void(std::optional<Phase>)> on_phase_;
  OnDecide on_decide_;
  std::function<void()> before_tick_;

  // Derived: derive() makes all of it, a tick keeps it up to date.
  std::vector<Transform> transforms_;
  std::vector<Vec2> outlines_;
  std::vector<double> row_radii_;
  std::vector<const partition::ObstacleShape*> row_shapes_;
  std::vector<FreeCircle> free_circles_;
  std::vector<std::uint8_t> not_drawn_;   // by the grid ray engine: a row each; empty where all are there
  std::vector<std::uint32_t> next_born_;  // of each reserve: who is the first that is unborn
  std::vector<Row> newborn_;              // that the index does not hold yet
  std::size_t robots_ = 0;
  std::size_t absent_ = 0;
  std::size_t ailing_ = 0;
  std::size_t stalled_ = 0;
  std::size_t held_ = 0;
  Links links_;            // but for its lists of what is composite, which are constants
  Experiment experiment_;  // but for its lists of what is to come, which are constants
  partition::BodyIndex index_;
  std::unique_ptr<partition::RayGrid> ray_grid_;

  // Scratch: of the tick under way, and for those who look on.
  std::vector<Motion> motions_;  // of who is not there: none, always
  Conflicts conflicts_;
  Effects effects_;
  std::vector<Placed> placed_;            // since the last step, each row once
  std::vector<Placed> placed_before_;     // that step
  std::vector<std::uint32_t> placed_at_;  // of each row: where it stands in placed_, from 1; 0: it does not
};

}  // namespace troupe::engine
