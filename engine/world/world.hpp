#pragma once

#include "engine/conflicts/movement.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/links/links.hpp"
#include "engine/sensing/fixed_targets.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"
#include "engine/state/world_state.hpp"
#include "engine/world/phase.hpp"
#include "engine/world/placed_rows.hpp"
#include "partition/body_index.hpp"
#include "partition/parallel.hpp"
#include "partition/ray_grid.hpp"
#include "partition/static_scene.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

class Blinkers;  // engine/state/blinkers.hpp
class Groups;    // engine/interventions/groups.hpp
// engine/observing/frame.hpp
struct Frame;
struct FrameScene;
struct FrameType;
// engine/ranks/replica.hpp
class Replica;
struct ReplicaParts;

/// Options of a World that affect the speed of a run, but never its results.
struct WorldOptions {
  /// Number of threads that compute a step; 0: one thread per processor that the process may use.
  unsigned threads = 0;
  /// Edge of the tiles of the spatial index, m. Tiles are the squares into which the index divides the plane.
  /// With 0, the World chooses the edge from the sizes of the bodies and the ranges of their sensors. Wide
  /// bodies can make the tiles wider than the given edge. The World uses narrower tiles if the given edge is
  /// so large that a search for neighbours would visit most bodies.
  double tile_size_m = 0;
};

/// The hashes of a state (docs/determinism.md): one for all state tables together, and one for each group of
/// tables. A state table holds one component of the state, such as the poses, with one row per body. The
/// hashes do not depend on the order of the rows. All sums are modulo 2^64.
struct Hashes {
  std::uint64_t state = 0;                            ///< sum of the hashes of all tables
  std::array<std::uint64_t, k_hash_groups> groups{};  ///< one per HashGroup: sum of the hashes of its tables
};

/// A running world: constants, the state, and the number of the tick (time step). The constants are made from
/// a WorldSpec, the *spec*, which describes the world. The state is stored in tables. Each table holds one
/// *component* of the state, such as the poses.
///
/// S(k) is the state after k ticks; S(0) is the initial state. step() computes S(k+1) from S(k). Between two
/// steps, a program may change S(k), for example with set_poses(). S(k+1) depends only on the changed S(k),
/// the spec with its seed, the calls of subscribe(), and the changes that the callback of before_tick()
/// makes.
///
/// The words below have these meanings:
/// - *robot*: a body with a drive.
/// - *static*: a body is static if it has no drive, no device and no controller, and cannot be gripped or
///   pushed. Static bodies do not move during a run. Their geometry is the *static scene*.
/// - *row*: the index of a body in the state tables. Every body that is not static has a row.
/// - *slot*: the index of a body in the state tables of its type, which have entries only for bodies of this
///   type.
/// - *device*: a sensor or other equipment of a body, such as a gripper. It is *due* once per period, which
///   is a number of ticks, and runs only in ticks in which it is due.
/// - *kind*: a table of functions (*hooks*) that implements one sort of device, drive or controller. The
///   Registry holds all kinds.
/// - *joint*: a frame of a body that a device moves. It is *at rest* while its displacement is zero.
/// - *tree*: a body that is not carried (the *root*), and all bodies that it carries, directly or through
///   others. They move together.
/// - *unborn*, *dead*: an unborn body is not yet in the world. A dead body has left the world and never comes
///   back.
/// - *reserve*: a list of bodies that are unborn at tick 0 and can be born later.
/// - *blocked*, *out of bounds*: a motion is blocked if another body is in the way, and out of bounds if it
///   would end outside WorldSpec::bounds. Such a motion does not take place.
/// - *effect*: an action of a device on another body.
/// - *intervention*: a change of the world at a given time, such as disabling robots.
/// - *fault*: a random failure of a robot. A fault breaks devices or slows the robot, or the robot is
///   *dropped out*: all its devices, its controllers and its drive stop.
/// - *rank*: one of several threads or processes that compute one world together. Each rank has a World.
class World {
 public:
  /// Builds the world in the state S(0). The registry, from which the world takes its kinds, must outlive the
  /// world.
  ///
  /// Throws InputError if the spec breaks a rule of check_rules(), for example because the program that made
  /// it did not call add_ground(), and for errors that the loader of a world file cannot find, such as a
  /// controller that needs a sensor which its robot does not have. The limits of the numbers in the spec are
  /// not checked. Throws StepError if a hook `start` of a kind throws.
  ///
  /// Adds warnings to `diagnostics` about these bodies:
  /// - Pairs of bodies that overlap at tick 0: one warning with the number of pairs, counted up to 10,000. If
  ///   diagnostics.thorough() is true, there is instead one warning for each of the first hundred pairs, and
  ///   one with the number of further pairs.
  /// - Bodies that extend below the floor (z = 0).
  World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics);
  World(WorldSpec, Registry&&, const WorldOptions&, Diagnostics&) = delete;
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // ---- the tick: engine/world/step.cpp
  /// Computes one tick: from S(k) to S(k+1). Apart from the first steps, a step allocates no memory unless a
  /// kind or a callback does.
  ///
  /// Throws StepError if a hook of a kind or an OnDecide callback throws. Also throws StepError if one of
  /// these is not finite: a command to the drive of a robot, the velocity that the drive computes, the
  /// odometry estimate, or the pose to which a device moves a joint. The docstring of StepError lists further
  /// causes. Exceptions of the callbacks of on_phase() and before_tick() propagate unchanged. After any
  /// exception the state is incomplete: see require_whole(). In these callbacks, and in hooks of kinds,
  /// step() throws std::logic_error.
  void step();
  /// Throws std::logic_error if the state is incomplete. The state becomes incomplete if step() throws, or if
  /// a hook of a kind throws in spawn(), reset() or restart(). Some rows may then have the state of the new
  /// tick, and others that of the old tick. A later call of reset(), restart() or restore() makes the state
  /// complete again.
  ///
  /// All functions that read or change the state as a whole call require_whole() first, such as step(),
  /// hashes(), tables(), frame(), spawn(), remove(), set(), set_poses(), set_estimate(), set_command() and
  /// set_disabled(). Accessors of single rows or columns, such as pose() or poses(), do not call it.
  void require_whole() const {
    if (is_half_made_) throw_half_made();
  }
  /// Throws std::logic_error while step() computes a tick: in a callback of on_phase(), and in a hook of a
  /// kind. Does not throw in the callback of before_tick(). The functions that may only be called between two
  /// steps, and would otherwise change or hash the state of half a tick, call this first: step(), reset(),
  /// restart(), restore(), spawn(), remove(), set(), set_poses(), set_disabled(), set_estimate(),
  /// set_command(), asked_of(), hash(), hashes(), on_phase() and before_tick(). call: name of the calling
  /// function, for the error.
  void require_between_steps(std::string_view call) const {
    if (is_in_tick_) throw_in_tick(call);
  }
  /// Throws std::out_of_range if there is no such row: for a Row that is not valid(), such as that of a
  /// static body, and for an index that is not below rows(). The functions below that change the state of one
  /// row, or test a pose for it, call this first. Accessors of single rows, such as stalled(), do not. call:
  /// name of the calling function, for the error.
  void require_row(Row row, std::string_view call) const {
    if (row.index() >= rows()) throw_no_row(row, call);
  }
  /// Throws std::invalid_argument if the body cannot be placed at this pose: if a number is not finite, or if
  /// the position is outside the bounds of the world.
  void require_pose(BodyId body, const Pose& pose) const;
  /// Returns to S(0), the state that the constructor or the last call of restart() made, and undoes the
  /// changes of set(). Callbacks and subscriptions (subscribe()) stay. The counters are 0 again. The function
  /// allocates no memory, and may be called after a step that threw. Throws StepError if a hook `start` of a
  /// kind throws.
  void reset();
  /// Goes to S(0) with another seed, and with other poses and colours of the bodies. The run then has the
  /// same results as a run of a new world whose spec has this seed and these bodies. Only the order of the
  /// rows may differ. The changes of set() are undone. Callbacks and subscriptions (subscribe()) stay. The
  /// function may be called after a step that threw.
  ///
  /// Throws std::invalid_argument, and changes nothing, if `bodies` has another size than the bodies of the
  /// spec. Throws StepError if a hook `start` of a kind throws. Throws InputError if the world uses the grid
  /// ray engine, which traces rays through a grid of cells, and if this grid cannot represent the new static
  /// scene. Throws std::logic_error if a hook `bind_world` of a kind rejects the new bodies. After an
  /// InputError or a std::logic_error, the world is in the state S(0) with the old seed and the old bodies.
  ///
  /// bodies     one BodySpec for each body of the spec, in the same order. Only poses and colours may differ
  ///            from the spec; the function does not check this. If a static body has another pose, the
  ///            static scene is rebuilt. If any pose or colour differs, the hooks `bind_world`, with which
  ///            kinds read the spec, are called again, and the hooks `prepare` before them
  /// registry   the registry that was passed to the constructor
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry);
  /// Counts that are not part of the state: of work since tick 0, and of changes.
  struct Counters {
    std::uint64_t beams = 0;            ///< rays cast by all sensors
    std::uint64_t conflict_rounds = 0;  ///< rounds of conflict resolution in all ticks: Conflicts::rounds()
    std::uint64_t settings = 0;         ///< changes by set() since the last step
  };
  Counters counters() const;  ///< the present counts
  /// A callback that restore() calls to write a saved state into the tables. The callback must set every
  /// field of every row. Before the call, restore() sets every byte of the tables to 0.
  using Fill = std::function<void(std::span<StateTable>)>;
  /// Restores a saved state. Calls `fill`, checks the filled tables, and recomputes all data that are derived
  /// from them. `tick`, `counters` and `state_hash` are the values of tick(), counters() and Hashes::state
  /// when the state was saved.
  ///
  /// Returns true if the state was restored. Returns false, with the world in the state S(0), if the filled
  /// tables do not have the hash `state_hash`, or if they contain values that no state has, such as a NaN in
  /// a pose. If `fill` throws, the exception propagates, and the world is also in the state S(0).
  bool restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash, const Fill& fill);
  /// For tests: overwrites all derived data with junk, and then computes them again. Derived data are all
  /// data that follow from the spec, the state, and what the program has set. A test then checks that the run
  /// continues with the same hashes (the "amnesia" test, docs/determinism.md).
  void forget();
  /// Switches a test mode on or off. The mode finds kinds of devices that read or change data of other bodies
  /// without having declared it (docs/determinism.md).
  ///
  /// - Reading: The hooks `sense` and `act` are called for one row at a time. During each call, all data of
  ///   other bodies that the kind has not declared are junk. If the kind reads such data, the hashes of the
  ///   run differ from those without the mode.
  /// - Changing: A kind declares which bodies its effects may have as targets and may change
  ///   (DeviceKind::scope). If an effect has another target or changes another body, the step throws a
  ///   StepError.
  ///
  /// The *reach* of a device is the radius of a disc around the origin of its body
  /// (DeviceKind::Prepared::reach_m). Bodies whose enclosing circles are outside this disc are hidden: they
  /// are not in the spatial index, and their poses, outlines and state are junk. Bodies in the tree of the
  /// device's body are never hidden. Bodies that are not hidden keep some components: `pose`, `carrier`,
  /// `life`, those of joints, and those that the kind declares (DeviceKind::reads). Their other components
  /// are junk. Only the device's own body keeps all components.
  ///
  /// The mode is slow: each call of a hook takes time proportional to the number of rows. Throws
  /// std::invalid_argument if the mode is switched on in a world with several threads or the grid ray engine.
  void hide_beyond_reach(bool on);
  /// For tests: gives the bodies other rows and slots, at random. The random numbers follow from `seed` and
  /// tick(). Rows and slots that the caller has stored, and references to table rows, then belong to other
  /// bodies. No result depends on rows and slots, so the run continues with the same hashes
  /// (docs/determinism.md). Throws std::logic_error if several ranks compute the world. Call this between
  /// steps.
  void shuffle_rows(std::uint64_t seed);
  /// The data of a row that World cannot compute from the spec or from other data: the state of the row's
  /// body, whether subscribe() was called for the body, and what placed_before_step() must know about it.
  struct RowState {
    BodyId body;                   ///< body of the row
    std::vector<std::byte> bytes;  ///< the data, for add_rows() of a world with the same spec
  };
  /// Removes the rows of bodies from this world. Returns their data, in the order of `bodies`. add_rows() can
  /// add the rows again, to this World or to another World that was made from the same spec. location() of
  /// the removed bodies is RowLocation::elsewhere. Call this between steps.
  ///
  /// If a body is in a tree with others, `bodies` must contain the whole tree. Throws std::invalid_argument
  /// if a body of a tree is missing, if a body has no row in this world, or if a body occurs twice. Throws
  /// std::logic_error if several ranks compute the world.
  ///
  /// If the rows of the world can be distributed among ranks, step() may be called before add_rows():
  /// why_replicated() (engine/ranks/halo.hpp) then returns an empty text. The remaining bodies do what they
  /// would do if the removed bodies were far away. There is one exception: an intervention that chooses
  /// bodies at random chooses among the remaining bodies only. In any other world, add_rows() must add the
  /// rows again before any other call. robots() still counts the removed robots if has_lives() is false.
  ///
  /// The tables and all other lists with one element per row may move in memory. They may also move in
  /// add_rows() and, if the rows are distributed among ranks, in gather().
  std::vector<RowState> remove_rows(std::span<const BodyId> bodies);
  /// Adds rows that remove_rows() has removed, in any order. Throws std::invalid_argument if location() of a
  /// body is not RowLocation::elsewhere, or if a body occurs twice. Call this between steps.
  void add_rows(std::span<const RowState> added);
  /// Number of completed ticks. During a step, from the phase `sense` on, it is the number of the tick that
  /// the step computes.
  std::uint64_t tick() const { return state_.now.tick; }
  double tick_s() const { return state_.spec.tick_s; }  ///< length of a tick, s
  /// Simulated time, s: tick() * tick_s().
  double time_s() const { return static_cast<double>(state_.now.tick) * state_.spec.tick_s; }
  /// Replaces the callback that step() calls at the beginning of each phase and at the end of the tick. The
  /// argument is the phase that begins, or std::nullopt at the end of the tick. An empty callback is not
  /// called. If several ranks compute the world, and the callback throws when the phase `move` begins or
  /// later, step() completes the tick without further calls before it throws the exception. Call on_phase()
  /// between steps.
  void on_phase(std::function<void(std::optional<Phase>)> callback) {
    require_between_steps("on_phase()");  // in its own callback, it would destroy the callback
    on_phase_ = std::move(callback);
  }
  /// Sets the callback that each step calls in the phase `intervene`, after it has applied the interventions
  /// and faults of the world file, and before any sensor runs. The callback may change the world in all ways
  /// that are allowed between two steps, except that step() and before_tick() throw std::logic_error there.
  /// If it replaces the state, with reset(), restart() or restore(), the step continues from the new state:
  /// it first applies the interventions and faults that are due in that state. The exceptions of the callback
  /// propagate from step(). A second call of before_tick() replaces the callback. Call before_tick() between
  /// steps.
  void before_tick(std::function<void()> callback) {
    require_outside_step("before_tick()");  // in its own callback, it would destroy the callback
    before_tick_ = std::move(callback);
  }
  /// A callback that step() calls in place of a controller, once per batch: the robots of one type that one
  /// call of the controller handles. The callback must itself call controller.kind->decide(controller.data,
  /// batch). Several threads call the callback at the same time, so it must be thread-safe. ControllerCheck
  /// (engine/observing/controller_check.hpp) installs such a callback.
  using OnDecide =
      std::function<void(const BodyType& type, const BodyType::Controller& controller, const DecideBatch&)>;
  /// Replaces the OnDecide callback. With an empty callback, step() calls the controllers itself again. Call
  /// this between steps.
  void on_decide(OnDecide callback) { on_decide_ = std::move(callback); }

  /// A view of those data of the world that devices may read (engine/sensing/sensing_view.hpp). It always
  /// shows the present state, and is valid as long as the world exists. Some functions take such a view as an
  /// argument, for example first_met() (engine/sensing/sight.hpp), which casts a ray.
  const CommittedView& view() const { return state_.view; }

  // ---- ranks: engine/ranks/ranks.cpp. Several ranks (threads or processes) may compute one world together.
  // Each rank then has a World and a Replica of its own (engine/ranks/replica.hpp). The functions below
  // exchange data between the ranks.
  /// Connects this world to its Replica, which exchanges messages with the other ranks; a null pointer
  /// disconnects it. Called by the constructor and the destructor of Replica. Returns references to the data
  /// of this world that the Replica reads and writes.
  ReplicaParts join(Replica* replica);
  /// Completes the state tables on rank 0 with the rows that only other ranks have computed. Functions that
  /// read whole tables call gather() first. Before several threads read the world at the same time, call
  /// gather() on the thread that calls step().
  ///
  /// Does nothing in any of these cases: the tables are already complete, this is not rank 0, a tick is being
  /// computed, or the world has no Replica.
  void gather() const {
    if (replica_ != nullptr) gather_rows();
  }
  /// Calls gather() if the rows of the world are distributed among the ranks (engine/ranks/halo.hpp): rank 0
  /// then has all rows until the next step. If the rows are not distributed, every rank already has the poses
  /// of all bodies. Code that reads the poses of all bodies, such as a measure (a number computed from the
  /// state), calls this function first.
  void gather_distributed() const;
  /// Replaces the state by that of rank 0. Replica calls this on the other ranks after a program has changed
  /// the state on rank 0. Calls `fill`, which writes the tables, and sets the tick. Recomputes all data that
  /// are derived from the state. Unlike restore(), checks nothing.
  ///
  /// is_in_tick   whether the interventions of the present tick have already been applied
  void adopt(std::uint64_t tick, const Fill& fill, bool is_in_tick);
  /// Makes the change of set() at the tick that rank 0 has. Replica calls this on the other ranks after a
  /// call of set() on rank 0. If the program has replaced the state on rank 0, for example by restore(), this
  /// rank may be at another tick: the function then sets the tick and applies the settings of earlier ticks,
  /// so that the change follows the same interventions as on rank 0. adopt() must follow in this case. Unlike
  /// set(), the function may be called while the state of this rank is incomplete.
  ///
  /// tick   tick() of rank 0
  Result<> set_at(std::uint64_t tick, const SettingSpec& setting, const Registry& registry);
  /// Removes the rows of `leaving`, and then adds those of `coming` after the remaining rows. Halo
  /// (engine/ranks/halo.hpp) calls this, also during a tick. Afterwards, the first `own` rows are the own
  /// rows, which this rank computes (WorldState::own_rows). The rows after them are copies of rows of other
  /// ranks.
  ///
  /// leaving   bodies with rows in this world. The last rows fill the places of the removed rows. If an own
  ///           row leaves, all copies must therefore leave too: otherwise a copy could get the place of the
  ///           own row
  /// coming    the rows to add; a RowState without bytes adds a row of zeros
  void exchange_rows(std::span<const BodyId> leaving, std::span<const RowState> coming, std::size_t own);
  /// Returns the data of a row, as RowState::bytes contains them.
  std::vector<std::byte> row_bytes(Row row);
  /// Number of bodies of each reserve that have been born, in the order of WorldSpec::reserves. All ranks
  /// have the same numbers.
  std::span<const std::uint32_t> births() const { return next_born_; }
  /// Sets the numbers of births() to `births`, the numbers on rank 0. Called after adopt() if the rows are
  /// distributed among ranks.
  void set_births(std::span<const std::uint32_t> births);

  // ---- constants and indices
  /// The spec that the world was made from, with later changes: restart() replaces the seed and the bodies,
  /// and set() adds interventions.
  const WorldSpec& spec() const { return state_.spec; }
  std::span<const BodyType> types() const { return state_.types; }      ///< compiled types, indexed by TypeId
  const partition::StaticScene& scene() const { return state_.scene; }  ///< geometry of the static bodies
  /// Spatial index of the bodies that have rows and are in the world. Between steps, and during a step until
  /// the bodies move, it has their present poses.
  ///
  /// After the bodies have moved in the phase `move`, the entries of the index are still those from before
  /// the motions, until the index is rebuilt in the phase `index`. The hooks DeviceKind::joints_moved and
  /// DeviceKind::apply run in between. In these hooks, BodyIndex::for_each_run() finds bodies by their poses
  /// and radii before the motions: to find the bodies that are now near a place, enlarge the box by the
  /// longest distance that a body can have moved. BodyIndex::for_each_near() must not be called there: it
  /// compares the entries of wide bodies with their present poses and radii, and may therefore miss a wide
  /// body, or visit a body several times that was wide before.
  ///
  /// If devices request births, and the reserve still has unborn bodies, the index is also rebuilt at the end
  /// of the phase `move`, before these births. It may then lack bodies that are born in this step.
  const partition::BodyIndex& index() const { return state_.index; }
  /// Spatial index of the parts of static bodies that fiducial finders (sensors of markers) detect.
  const FixedTargets& fixed_targets() const { return state_.fixed_targets; }
  /// Cells through which the grid ray engine traces rays (RangingEngine::grid). Null if the world uses the
  /// exact ray engine.
  const partition::RayGrid* ray_grid() const { return state_.ray_grid.get(); }
  /// Sizes of the squares of the spatial index: cells, and tiles, each of which consists of several cells. No
  /// result depends on the sizes.
  const partition::GridGeometry& geometry() const { return state_.geometry; }
  /// The worker threads of step(). Between steps, other code may use them, such as measures (numbers computed
  /// from the state).
  partition::Parallel& parallel() { return parallel_; }
  /// Number of rows in this world: one for each body that is not static. The constructor orders the rows by
  /// the positions of their bodies at tick 0, so that neighbours in space are close in memory. The rows of
  /// unborn bodies come last.
  std::size_t rows() const { return state_.bodies.size(); }
  /// Number of robots that are in the world at tick 0.
  std::size_t robots_at_start() const { return robots_at_start_; }
  /// Number of robots that are in the world now.
  std::size_t robots() const;
  BodyId body(Row row) const { return state_.view.body(row); }  ///< body of a row
  /// Where the row of a body is. RowLocation::here: in this World. RowLocation::elsewhere: on another rank,
  /// or removed by remove_rows(). RowLocation::none: the body is static and has no row.
  RowLocation location(BodyId body) const { return state_.view.location(body); }
  /// Row of a body. The result is not valid() for a static body, which has no row. Throws std::logic_error if
  /// location() is RowLocation::elsewhere.
  Row row(BodyId body) const { return state_.view.row(body); }
  const BodyType& type(Row row) const { return state_.view.type(row); }  ///< type of the row's body
  const BodyType& type(BodyId body) const { return state_.type(body); }  ///< type of any body, static or not
  /// Slot of a row: the index of its body in the tables that have entries only for bodies of its type.
  std::size_t slot(Row row) const { return state_.view.slot(row); }
  /// Returns the body with this name. If several bodies have the name, returns the one with the highest id.
  /// If no body has the name, returns the body for which the name is an alias (WorldSpec::aliases). If there
  /// is no such body either, the result is not valid(). Unborn and dead bodies are found as well.
  /// Thread-safe.
  BodyId find(std::string_view name) const;

  // ---- the state
  /// The state tables. Members of BodyType such as Device::table are indices into this list.
  std::span<const StateTable> tables() const {
    require_whole();
    gather();
    return state_.tables;
  }
  /// Returns the tables, without rows, that types without bodies would add to tables(): those of their
  /// devices, joints, controllers and odometry. Their names and fields are valid in the world although no
  /// body has them, for example because an option such as --robots has removed all bodies of the type.
  std::vector<StateTable> unused_tables() const;
  /// Returns the index of the row's body in one of the tables(): the row itself if the table has entries for
  /// bodies of all types, otherwise the slot. The table must have an entry for the body. If it has none, the
  /// result is meaningless, and may be out of range; find_in() checks this.
  std::size_t row_in(const StateTable& table, Row row) const { return state_.row_in(table, row); }
  /// Like row_in(), but returns std::nullopt if the table has no entry for the row's body.
  std::optional<std::size_t> find_in(const StateTable& table, Row row) const {
    return state_.find_in(table, row);
  }
  /// Pose of each row, world frame. A dead body has the pose at which it died; all values of an unborn body
  /// are 0.
  std::span<const Pose> poses() const { return state_.view.poses(); }
  /// Pose of any body, also of a static body, in the world frame. A dead body has the pose at which it died.
  /// All values of an unborn body are NaN. Throws std::logic_error if location() is RowLocation::elsewhere.
  Pose pose(BodyId body) const { return state_.view.pose(body); }
  /// The pose of the row's body as a transform. It is stored, not computed by this call, and equals
  /// Transform(pose) bit for bit.
  const Transform& transform(Row row) const { return state_.view.transform(row); }
  /// Velocity that the drive of each row computed last, body frame, m/s and rad/s. It is 0 for a body that
  /// has no drive or is not in the world. The phase `actuate` of each tick sets it to 0 for a body that is
  /// disabled or dropped out by a fault, and for a body whose drive has an empty power supply. A blocked
  /// motion does not change it.
  std::span<const Velocity> velocities() const { return state_.as<Velocity>(WorldState::k_velocity); }
  /// Command to the drive of each row. The numbers have no meaning for rows without a drive.
  std::span<const Command> commands() const { return state_.as<Command>(WorldState::k_command); }
  /// Whether the row's last motion was blocked or out of bounds. False before the first tick, and after
  /// set_poses() has placed the body.
  bool stalled(Row row) const;
  /// Whether the row's last motion was out of bounds.
  bool is_out_of_bounds(Row row) const;
  /// What blocked the row's body in the last tick. Known only if the state has the component `contact`
  /// (WorldSpec::contacts), or in ticks that begin after a call of watch_contacts(); otherwise all members
  /// are zero, as for a body that nothing blocked.
  Contact contact(Row row) const;
  /// Calls throw_no_contacts() if the state does not have the component `contact`.
  void require_contacts() const {
    if (!state_.contact_table) throw_no_contacts();
  }
  /// Lets each later step find out what blocks bodies, for contact(). The state and its hashes do not change.
  /// If the rows are distributed among ranks, call gather() before contact(). Call this between steps.
  void watch_contacts();
  /// Whether watch_contacts() was called.
  bool watches_contacts() const { return state_.watches_contacts; }
  /// Estimated pose of a robot, m and rad. The Localization of the robot's drive says how the robot estimates
  /// its pose, and in which frame. By default, the estimate is the true pose in the world frame. With
  /// odometry, its frame is by default the robot's pose at tick 0 or at its birth. For a body without a
  /// drive, the result is the true pose in the world frame.
  Pose estimate(Row row) const { return estimates(type(row)).of(row, slot(row)); }
  /// Estimated poses of all bodies of a type, in the same frames as those of estimate(). The result is valid
  /// as long as the world exists.
  Estimates estimates(const BodyType& type) const;
  /// Overwrites the odometry estimate of a robot with a pose, m and rad, in the same frame as estimate(). The
  /// z of the pose is ignored. The heading is wrapped into [-pi, pi]. Throws std::logic_error if the robot
  /// has no odometry or is not in the world, and std::invalid_argument if a number of the pose, z included,
  /// is not finite. Call this between steps.
  void set_estimate(Row row, const Pose& pose);
  /// Overwrites the command to the drive of a robot. The drive executes the new command from the next step
  /// on. Call this between steps. If a number is not finite, the next step in which the drive runs throws a
  /// StepError. Throws std::logic_error if the state is incomplete (require_whole()).
  void set_command(Row row, const Command& command) {
    require_whole();
    require_between_steps("set_command()");
    require_row(row, "set_command()");
    touch();
    state_.tables[WorldState::k_command].as<Command>(row.index()) = command;
  }
  /// Frame of the parts and devices on a joint of the row's body: the present pose of the body in the world
  /// frame, combined with the present displacement of the joint from rest. For k_rigid, the frame is the pose
  /// of the body. `joint` is an index into BodyType::joints or k_rigid. Details and an example:
  /// SensingView::mount().
  Mount mount(Row row, std::int32_t joint) const { return state_.view.mount(row, joint); }
  /// Upper bound on the distance from the origin of the row's body to any point of the body, m; negative if
  /// the body is not in the world. Details: SensingView::radius().
  double radius(Row row) const { return state_.view.radius(row); }
  /// Height by which the parts on a joint of the row's body are above their places with all joints at rest,
  /// m. The joints that this joint is mounted on are included. `joint` is an index into BodyType::joints, or
  /// k_rigid, for which the height is 0.
  double lift(Row row, std::int32_t joint) const { return state_.view.lift(row, joint); }
  /// Present pose of a joint of the row's body, relative to the pose of the joint at rest, m and rad. `joint`
  /// is an index into BodyType::joints.
  const Pose& joint_state(Row row, std::size_t joint) const { return state_.joint_state(row, joint); }
  /// The body that carries the row's body; std::nullopt if it is not carried.
  std::optional<BodyId> carrier(Row row) const { return state_.view.carrier(row); }
  /// Number of carried bodies.
  std::size_t carried_count() const { return state_.now.carried; }
  /// Whether two bodies are in the same tree: one carries the other, directly or through others, or a third
  /// body carries both. True if a and b are the same row.
  bool same_tree(Row a, Row b) const { return state_.view.same_tree(a, b); }
  /// The row of the root of the tree that contains the row's body; the row itself if its body is not carried.
  Row root(Row row) const { return state_.now.carried > 0 ? Row(state_.roots[row.index()]) : row; }
  /// Upper bound on the distance from the origin of the root to any point of a tree, m, whatever the poses of
  /// the joints. It holds for all trees of two or more bodies whose rows are in this world; 0 if there are no
  /// such trees. Drive devices (DeviceKind::drives) must not move joints of these bodies: see
  /// Links::farthest().
  double farthest_in_trees() const;
  /// Attaches the body `cargo` to the body `carrier`. From then on, the cargo keeps its present pose relative
  /// to a joint of the carrier: the joint with the index `joint` in BodyType::joints. If `joint` is k_rigid,
  /// the cargo keeps its pose relative to the carrier itself. Both bodies must be in the world. Only
  /// DeviceKind::apply of a kind that sets DeviceKind::carries may call this. In `apply` of another kind, the
  /// call throws std::logic_error, because the effects on trees that may change are applied in groups if the
  /// rows are distributed among ranks (SharedEffects).
  ///
  /// Returns false and changes nothing in these cases:
  /// - The cargo is already carried.
  /// - The cargo is the carrier, or carries the carrier, directly or through others.
  /// - The carrier has no device that can carry bodies (DeviceKind::carries).
  /// - More than Links::k_most_carriers (1000) bodies would carry a body, directly or through others.
  bool attach(Row cargo, Row carrier, std::int32_t joint) {
    require_carries("attach()");
    return links_.attach(cargo, carrier, joint);
  }
  /// Detaches a body from its carrier; its pose stays. Does nothing if the body is not carried. Only
  /// DeviceKind::apply of a kind that sets DeviceKind::carries may call this. In `apply` of another kind, the
  /// call throws std::logic_error, as attach() does.
  void release(Row cargo) {
    require_carries("release()");
    links_.release(cargo);
  }

  // ---- births and deaths: engine/world/lives.cpp
  /// Whether bodies of this world can be born or die. They can if the world has reserves, if a device or an
  /// intervention can remove bodies, or if WorldSpec::mortal is set. In all other worlds the state has no
  /// component `life`.
  bool has_lives() const { return state_.life_table.has_value(); }
  /// Returns one of: the row's body is in the world (always if !has_lives()), it is unborn, it is dead.
  Presence presence(Row row) const { return state_.view.presence(row); }
  /// Whether the row's body is in the world. An unborn or dead body is not in the spatial index, and does not
  /// sense, decide or move. Its state is 0, except for the component `life` and the pose of a dead body.
  bool is_there(Row row) const { return state_.view.is_there(row); }
  /// Number of rows whose bodies are unborn or dead.
  std::size_t absent_count() const { return state_.now.absent; }
  /// Position of the row's body at its birth, or at tick 0 if it was present then; m, world frame. For an
  /// unborn body it is (0, 0).
  Vec2 origin(Row row) const;
  /// Number of ticks that were completed when the body was born; 0 if it was present at tick 0 or is unborn.
  /// The periods of the body's devices, drive and controllers count from that tick.
  std::uint64_t birth_tick(Row row) const { return state_.view.birth_tick(row); }
  /// Returns the index in WorldSpec::reserves of the reserve of a population. A population is a set of bodies
  /// with the same name and different numbers: "ant" is the population of "ant0", "ant1", and so on. The
  /// result is std::nullopt if there is no population with this name, or if it has no reserve.
  std::optional<std::size_t> reserve(std::string_view population) const;
  /// Number of bodies of a reserve (an index into WorldSpec::reserves, which must exist) that are not yet
  /// born.
  std::size_t unborn(std::size_t reserve) const {
    return state_.spec.reserves[reserve].count - next_born_[reserve];
  }
  /// Spawns the next body of a reserve at a pose, m and rad, world frame. `reserve` is an index into
  /// WorldSpec::reserves. Apart from its pose and the component `life`, the new body has the
  /// state of a body at tick 0. If the pose is not free (is_free()), or if all bodies of the reserve have
  /// been born, no body is born, and Birth::status gives the reason.
  ///
  /// Throws std::out_of_range if the reserve does not exist, and std::invalid_argument if the pose is not
  /// finite. Throws StepError if a hook `start` of a kind throws; the state is then incomplete
  /// (require_whole()). Each birth rebuilds the spatial index of all
  /// bodies. Call this between steps.
  Birth spawn(std::size_t reserve, const Pose& pose);
  /// Removes a body from the world. Bodies that it carries stay where they are. Does nothing if the body is
  /// not in the world. Throws std::logic_error if has_lives() is false. Each call rebuilds the spatial index
  /// of all bodies. Call this between steps.
  void remove(Row row);

  // ---- experiments: engine/interventions/experiment.cpp, settings.cpp
  /// Whether the row's body is disabled by an intervention or a program, or dropped out by a fault. The
  /// devices, controllers and drive of such a body do not run. The body does not move on its own, but it
  /// still blocks motions and is visible to sensors.
  bool is_disabled(Row row) const { return state_.now.impaired > 0 && state_.condition(row).out != 0; }
  /// Whether no fault has broken the row's device, and is_disabled() is false for the row. `device` is an
  /// element of BodyType::devices of the row's type.
  bool works(Row row, const BodyType::Device& device) const { return state_.view.works(row, device); }
  /// Whether bodies of this world can be disabled or have faults. They can if the world has an intervention
  /// that disables or enables bodies, if it has faults, or if WorldSpec::mortal is set. In all other worlds
  /// the state has no component `condition`.
  bool has_conditions() const { return state_.condition_table.has_value(); }
  /// Disables or enables a body, as the intervention `disable` or `enable` of a world file does. Returns
  /// false and changes nothing if the body already is as requested, or is not in the world. Enabling a body
  /// does not end a drop-out by a fault. Throws std::logic_error if has_conditions() is false. Call this
  /// between steps.
  bool set_disabled(Row row, bool disabled);
  /// Changes parameters of a type, for all its bodies, as the intervention `set` of a world file does. The
  /// change lasts until reset() or restart(). Until then, spec() contains it as an intervention at the
  /// present time. If the parameters cannot change during a run, returns an error that says why, and leaves
  /// the world unchanged. If several ranks compute the world, all of them apply the change. `registry` must
  /// be that of the constructor. Call this between steps, or in the callback of before_tick().
  Result<> set(const SettingSpec& setting, const Registry& registry);
  /// Number of calls of set() since construction, reset() or restart() that have changed parameters. Each of
  /// them has added one intervention at the end of ExperimentSpec::at.
  std::size_t settings_made() const { return experiment_.made; }
  /// The spec of a type with its present parameters, which the intervention `set` and the function set() may
  /// have changed.
  TypeSpec present_type(TypeId type) const;
  /// Longest reach of a device, m, over the whole run. The reach of a device is the distance from its body at
  /// which it can sense bodies (DeviceKind::Prepared::reach_m). All types that are not static count. For each
  /// of their devices, the present parameters count, and all parameters that interventions of spec() set.
  double longest_reach() const;

  using Placed = engine::Placed;  ///< argument of set_poses(): a row, and a pose for its body
  /// Sets the poses of bodies. Call this between steps. Each call rebuilds the spatial index of all bodies,
  /// so pass all poses in one call. If a row occurs twice, its last pose counts.
  ///
  /// A pose may overlap other bodies. Bodies that overlap can later move apart, but not deeper. If a body
  /// carries others, they move with it. A robot that was stalled() is no longer stalled. Its velocity and its
  /// odometry estimate do not change.
  ///
  /// Throws std::invalid_argument, and moves no body, if a body of the list is carried or not in the world,
  /// or if a pose is not finite or out of bounds.
  void set_poses(std::span<const Placed> placed);
  /// The bodies that set_poses() or the intervention `move` placed between the last two steps, or in the
  /// phase `intervene` of the last step. All bodies that were carried when this happened are listed too,
  /// because they may have moved with their carriers. Each row occurs once. Placed::pose is the pose before
  /// the motions of the last step. Measures of the distance travelled use this list, so that jumps do not
  /// count as travel. The list is empty before the first step. It is not part of the state.
  std::span<const Placed> placed_before_step() const { return placed_before_.all(); }
  /// Whether the row's body could be placed at a pose (world frame, m and rad). True if its origin would be
  /// within the world's bounds, and the body would overlap neither the static scene nor another body that is
  /// an obstacle. False if the pose is not finite.
  ///
  /// The test includes the bodies that the row's body carries, and uses the present poses of its joints. If
  /// the body is unborn or dead, its joints are taken to be at rest. In two cases only the bounds count: the
  /// row's body is carried, or neither it nor a body that it carries is an obstacle.
  ///
  /// In the hooks DeviceKind::apply and DeviceKind::born, the result false is correct, but the result true
  /// may be wrong: the test may miss bodies that have moved, or whose joints have moved, in this step (see
  /// index()). Between steps, and during a step until the bodies move, it misses no body.
  bool is_free(Row row, const Pose& pose) const;
  /// The state table of a device, with one table row per slot of the device's type. The state of a sensor is
  /// its readings. Before the sensor has run for the first time, they are 0 or as DeviceKind::start has set
  /// them.
  const StateTable& percepts(const BodyType::Device& sensor) const {
    gather();
    return state_.tables[sensor.table];
  }
  /// Makes every sensor and every other device of a body run, including those that no controller uses. Throws
  /// std::out_of_range if there is no such body, or if it has no row. Call this before the first step.
  void subscribe(BodyId body) {
    gather_distributed();  // the row may be on another rank
    const Row row = body.index() < state_.rows.size() ? this->row(body) : Row();
    require_row(row, "subscribe()");
    touch();
    state_.subscribed[row.index()] = 1;
  }
  /// Bodies for which subscribe() was called and which have a row in this World, in ascending order of ids.
  std::vector<BodyId> subscribed() const;
  /// Whether a device of the row is in use. It is in use if a controller uses it or the world file makes it
  /// active (BodyType::Device::active), or if subscribe() was called for the body.
  bool senses(Row row, const BodyType::Device& sensor) const { return state_.view.senses(row, sensor); }
  /// Whether a device of the row's body gets power: false if its power supply is empty. `supply` is the index
  /// of this supply in BodyType::devices, from the member BodyType::Device::supply of the device. For
  /// std::nullopt (the device needs no supply) the result is true.
  bool is_supplied(Row row, std::optional<std::size_t> supply) const {
    return state_.view.is_supplied(row, supply);
  }
  /// Whether the row's device is switched on: no controller has switched it off.
  bool is_on(Row row, const BodyType::Device& device) const { return state_.view.is_on(row, device); }
  /// Whether the row's device runs in the ticks in which it is due. It runs if senses(), is_on(), works() and
  /// is_supplied() are true for it.
  bool runs(Row row, const BodyType::Device& device) const { return state_.view.runs(row, device); }
  /// The table of the commands to a device, with one table row per slot of the device's type. The device must
  /// take commands: throws std::logic_error if it does not. A program may change the commands. Call this
  /// between steps.
  StateTable& asked_of(const BodyType::Device& device) {
    require_between_steps("asked_of()");
    if (!device.command_table) throw_no_commands(device);
    touch();
    return state_.tables[*device.command_table];
  }
  /// The state table of a device, with one table row per slot of the device's type. DeviceKind::apply,
  /// DeviceKind::born, and programs between steps may change it through this reference.
  StateTable& state(const BodyType::Device& device) {
    touch();
    return state_.tables[device.table];
  }
  /// Vertices of the outlines of the row's body at their present places, m, world frame. Details:
  /// SensingView::outline().
  std::span<const Vec2> outline(Row row) const { return state_.view.outline(row); }
  /// Hash of one table: the sum of the hashes of its rows, modulo 2^64. The hash of the state (Hashes::state)
  /// is the sum of the hashes of all tables. Call this between steps.
  std::uint64_t hash(const StateTable& table);
  /// Hashes of the present state, computed on the worker threads. Call this between steps.
  Hashes hashes();

  // ---- counters
  std::uint64_t beams_cast() const { return beams_; }  ///< rays cast by all sensors since tick 0
  /// Number of robots whose last motion was blocked or out of bounds. If the rows are distributed among
  /// ranks, call gather() before: otherwise robots with rows on other ranks do not count.
  std::size_t stalled_count() const { return movement_.stalled(); }
  /// Number of robots that stalled_count() counts because their last motion was out of bounds.
  std::size_t out_of_bounds_count() const { return movement_.out_of_bounds(); }
  /// Number of rounds in which conflicts between motions were resolved, summed over all ticks since tick 0:
  /// see Conflicts::rounds().
  std::uint64_t conflict_rounds() const { return conflict_rounds_; }
  /// Mean straight-line distance between the present position of a robot and its origin(), over all robots in
  /// the world, m; 0 if there are none. If the rows are distributed among ranks, call gather() before.
  double mean_displacement() const;

  // ---- for viewers
  /// The data for drawing the world that do not change during a run. FrameScene::rangers (the rangers whose
  /// beams can be drawn) is empty.
  FrameScene frame_scene() const;
  /// The data for drawing the world that change with each tick. The members Frame::time_s, `tick`, `mobile`
  /// and `types` are set. All other members are empty.
  Frame frame() const;

  /// While an object of this class exists, functions that change the world throw std::logic_error. MeasureSet
  /// has such an object while it calls measures, because measures must not change the world.
  class Frozen {
   public:  /// Freezes the world until the destructor runs.
    explicit Frozen(World& world) : world_(world), before_(std::exchange(world.is_frozen_, true)) {}
    ~Frozen() { world_.is_frozen_ = before_; }
    Frozen(const Frozen&) = delete;
    Frozen& operator=(const Frozen&) = delete;

   private:
    World& world_;
    bool before_;
  };

 private:
  [[noreturn]] static void throw_frozen();
  [[noreturn]] void throw_half_made() const;
  [[noreturn]] static void throw_in_tick(std::string_view call);
  [[noreturn]] static void throw_in_before_tick(std::string_view call);
  [[noreturn]] void throw_no_row(Row row, std::string_view call) const;
  [[noreturn]] static void throw_no_commands(const BodyType::Device& device);
  /// Throws std::logic_error wherever require_between_steps() throws, and in the callback of before_tick().
  void require_outside_step(std::string_view call) const {
    require_between_steps(call);
    if (is_in_before_tick_) throw_in_before_tick(call);
  }
  void require_carries(std::string_view call) const;
  /// Exists while work changes the state. The constructor clears is_half_made_, and the destructor sets it if
  /// the work threw an exception. If a callback in the work caught an exception of inner work, such as a
  /// birth, is_half_made_ stays set.
  class Completion {
   public:
    explicit Completion(World& world) : world_(world) { world_.is_half_made_ = false; }
    ~Completion() {
      if (std::uncaught_exceptions() > before_) world_.is_half_made_ = true;
    }
    Completion(const Completion&) = delete;
    Completion& operator=(const Completion&) = delete;

   private:
    World& world_;
    int before_ = std::uncaught_exceptions();
  };
  void check_size(Diagnostics& diagnostics) const;
  void check_reserves(Diagnostics& diagnostics) const;
  std::vector<BodyId> rows_by_place(const partition::GridGeometry& geometry) const;
  void build_rows(const partition::GridGeometry& usual);
  void build_scene();
  void build_tables();
  void build_lives();
  /// Fills the tables with the state at tick 0, and computes all derived data.
  void start();
  static Pose at_start(const Pose& pose);
  /// Gives a row the state that its body has at tick 0 or at its birth, with this pose (world frame). All
  /// bytes of the row must be 0 before.
  void start(Row row, const Pose& pose);
  void start(Row row, const BodyType::Drive& drive);
  /// Computes all derived data: those that are neither constant, nor state, nor set by the program. It reads
  /// only the spec, the tick and the tables, never earlier derived data. It is called after every start,
  /// reset and restore.
  void derive();
  /// The part of derive() without the odometry errors of robots and the interventions and faults of the spec.
  void derive_state();
  /// The part of derive() for one row; also called for bodies that are born or die.
  void derive(Row row);
  // engine/world/row_order.cpp
  void begin_row_change(std::string_view what) const;
  void move_rows(std::span<const std::uint32_t> to, std::span<const std::vector<std::uint32_t>> slots_to);
  void derive_rows();
  void drop_rows(const std::vector<bool>& leaves);
  std::vector<bool> make_room_for(std::span<const RowState> added);
  void append_rows(std::span<const RowState> added);
  void set_state(Row row, std::span<const std::byte> bytes);
  void build_ray_grid(Diagnostics& diagnostics);
  void report_overlaps(Diagnostics& diagnostics);

  void make_tick();
  std::size_t least_sensing_batch(std::size_t rows) const;
  void sense();
  void actuate();
  void decide();
  DeviceBatch device_batch(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device);
  void drive(std::span<const Row> rows, const BodyType::Drive& drive, std::atomic<std::uint32_t>& faulty);
  void halt_disabled(std::span<const Row> rows, const BodyType& type);
  void halt_spent(std::span<const Row> rows, const BodyType::Drive& drive);
  void halt_stopped(std::span<const Row> rows, const BodyType::Device& device);
  void halt(Row row, const BodyType::Device& device);
  void decide(std::span<const Row> rows, const BodyType& type, const BodyType::Controller& controller);
  void decide_together();
  void move();
  void check_effects();
  void check_order(std::span<const Effect> effects) const;
  Result<> check(const Effect& effect) const;
  void apply_effects();

  // engine/world/lives.cpp
  void derive_lives();
  bool lives_hold(std::uint64_t tick) const;
  void count_present();
  BodyId next_unborn(std::size_t reserve) const;
  Birth give_birth(std::size_t reserve, std::uint32_t trials,
                   const std::function<Pose(std::uint32_t)>& place);
  bool has_many_newborn() const;
  void index_newborn();
  void follow_newborn();
  std::uint32_t first_free(BodyId id, const partition::ObstacleShape& shape, std::uint32_t trials,
                           const std::function<Pose(std::uint32_t)>& place) const;
  bool is_free(BodyId id, const partition::ObstacleShape& shape, const Pose& pose) const;
  void enter(Row row, const Pose& pose);
  void leave(Row row);
  template <class Work>
  void attempt(Work&& work);
  void die(Row row);
  void resolve_lives(std::span<const Effect> effects);

  // engine/interventions/experiment.cpp
  void build_experiment(const Registry& registry, Diagnostics& diagnostics);
  /// Compiles an intervention of the spec. `types` is a map from TypeId to the spec of a type. It contains
  /// each type whose parameters earlier interventions change, with the changed parameters. The function adds
  /// the changes of this intervention to the map.
  void build_intervention(Experiment::Intervention& intervention, const Registry& registry, Groups& groups,
                          std::map<std::uint32_t, TypeSpec>& types, Diagnostics& diagnostics);
  void build_faults(const Registry& registry, Groups& groups, Diagnostics& diagnostics);
  void build_fault(std::size_t at, const Registry& registry, Groups& groups, Diagnostics& diagnostics);
  void build_conditions();
  /// Computes from the tick which interventions have been applied: those whose tick is before the present
  /// one. The next step applies the interventions of the present tick.
  void derive_experiment();
  void find_due();
  bool conditions_hold() const;
  void count_impaired();
  void intervene();
  bool carry_out(Experiment::Intervention& intervention);
  bool move_body(const Experiment::Intervention& intervention);
  void list_candidates(const Experiment::Intervention& intervention);
  bool remove_all(std::span<const Experiment::Candidate> chosen);
  void toggle_disabled(Row row);
  /// Chooses as many of Experiment::candidates as the group asks for: those with the lowest keys, which are
  /// random numbers. Returns them in order of ids.
  std::span<const Experiment::Candidate> choose(const GroupSpec& group);
  bool add(const Experiment::Intervention& intervention);
  Pose place_to_add(const Experiment::Intervention& intervention, std::uint32_t number,
                    std::uint32_t trial) const;
  std::uint64_t next_fault_tick(std::uint32_t fault, BodyId body, std::uint64_t from) const;
  Experiment::FaultEvent take_fault_event();
  void apply_fault_event(const Experiment::FaultEvent& event);
  double speed_scale(Row row) const;

  // engine/interventions/settings.cpp
  /// Compiles a change of parameters, `setting`, into `intervention`. `type` is the type whose parameters
  /// change, with those of tick 0. `types` is as for build_intervention(). The error says what is wrong with
  /// the change.
  Result<> build_setting(const SettingSpec& setting, const Registry& registry, const BodyType& type,
                         std::map<std::uint32_t, TypeSpec>& types, Experiment::Intervention& intervention);
  void bind_kinds_again(const Registry& registry);
  bool is_setting(const Experiment::Intervention& intervention) const;
  void swap_setting(Experiment::Intervention& intervention);
  void swap_settings(std::size_t count);
  void swap_settings_back(std::size_t count);
  std::size_t find_basis(TypeId type, std::size_t count) const;
  TypeSpec type_at(TypeId type, std::size_t count) const;
  class WithoutSettings;
  Result<> insert_setting(const SettingSpec& setting, const Registry& registry);
  Result<std::vector<std::pair<std::size_t, Experiment::Intervention>>> build_settings_from(
      std::size_t first, TypeId changed_type, const Registry& registry, const BodyType& type,
      std::map<std::uint32_t, TypeSpec>& types);
  void forget_settings();

  void report_joints();
  void report_collisions();
  void add_feelers(Row root, std::uint32_t mover);
  void redraw_ray_grid();
  void place(Row row, const Pose& pose);
  void carry_placed();
  void remember_placed(Row row);
  void begin_placing();
  void index_bodies();
  FrameType look_of(std::size_t t, Row row) const;
  void begin(Phase phase);
  void gather_rows() const;
  /// Called when a program is about to change the state, so that the other ranks receive the changed state
  /// before the next tick. Does nothing during a tick.
  void touch() {
    require_unfrozen();
    if (replica_ != nullptr) touch_rows();
  }
  void require_unfrozen() const {
    if (is_frozen_) throw_frozen();
  }
  void touch_rows();
  RowRange own_rows() const;
  template <class Work>
  void for_seeing(std::span<const Row> rows, const BodyType& type, const BodyType::Device& device,
                  Work&& work);

  // Every member belongs to one of five groups: constant, state, set by the program, derived, or scratch.
  // Only state is saved, so no member of another group may carry information from one tick to the next.

  WorldState state_;  // constants, state, and the places of bodies, which are derived
  partition::Parallel parallel_;
  Links links_;        // derived, except the constant list of bodies whose shapes can change
  Movement movement_;  // derived and scratch, except the constants: which bodies push and can be pushed

  // Constants: made from the spec by the constructor.
  mutable NameMap names_;  // built by the first find(), because most runs never call it
  mutable std::once_flag names_made_;
  std::size_t robots_at_start_ = 0;
  bool has_collisions_ = false;  // a device feels collisions (DeviceKind::collide)
  bool has_collective_ = false;  // a type has a controller with ControllerKind::is_collective

  // State, and counters.
  bool is_half_made_ = false;    // a step threw: only reset(), restart() and restore() are allowed
  bool is_frozen_ = false;       // an object Frozen exists
  bool must_not_carry_ = false;  // the hook `apply` of a kind without `carries` is running
  bool is_in_tick_ = false;  // step() is computing a tick, and the callback of before_tick() is not running
  bool is_in_before_tick_ = false;  // the callback of before_tick() is running
  std::uint64_t beams_ = 0;
  std::uint64_t conflict_rounds_ = 0;

  // Set by the program.
  std::function<void(std::optional<Phase>)> on_phase_;
  OnDecide on_decide_;
  std::function<void()> before_tick_;
  struct BlinkersDeleter {
    void operator()(Blinkers* blinkers) const;
  };
  std::unique_ptr<Blinkers, BlinkersDeleter> blinkers_;  // null: devices see everything
  Replica* replica_ = nullptr;                           // null: this world computes all rows itself

  // Derived: computed by derive(), kept up to date by each tick.
  std::vector<std::uint32_t> next_born_;  // one per reserve: index of its first unborn body in the reserve
  struct Newborn {
    BodyId body;
    Pose pose;  // at birth, world frame
  };
  std::vector<Newborn> newborn_;  // bodies that the index does not contain yet
  std::size_t robots_ = 0;        // among the own rows
  Experiment experiment_;  // except its lists of interventions, which only set() extends, and faults, which
                           // are constant
  std::vector<double> grid_lifts_;  // height offset of each outline that the grid ray engine draws, m

  // Scratch: data of the current tick, and the poses that programs set, which measures read.
  Effects effects_;
  /// A collision of the body `mover` that devices of the body `feeler` feel, both as rows.
  struct Felt {
    Row feeler;
    std::uint32_t mover;
    bool as_mover;  // the feeler belongs to the tree of the mover
  };
  std::vector<Felt> felt_;
  std::vector<Row> deciding_;  // robots with collective controllers, then those for which one of them decides
  PlacedRows placed_;          // set since the last step
  PlacedRows placed_before_;   // set between the last two steps
};

}  // namespace troupe::engine
