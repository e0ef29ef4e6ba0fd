#pragma once

#include "engine/conflicts/movement.hpp"
#include "engine/interventions/interventions.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/links/links.hpp"
#include "engine/rows/lives.hpp"
#include "engine/rows/measured_world.hpp"
#include "engine/rows/places.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/rows/rows.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/spec/world_spec.hpp"
#include "engine/state/hashes.hpp"
#include "engine/state/world_state.hpp"
#include "engine/world/activities.hpp"
#include "engine/world/derivation.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/tick.hpp"
#include "partition/parallel.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

/// Options of a World that affect the speed of a run, but never its results.
struct WorldOptions {
  /// Number of threads that compute a step; 0: one thread per processor that the process may use.
  unsigned threads = 0;
  /// Edge of the tiles of the spatial index, m; 0: chosen. See choose_grid().
  double tile_size_m = 0;
};

/// A running world, which is put together from the parts below: the state with the constants, and the objects
/// that change it.
///
/// S(k) is the state after k ticks. step() computes S(k+1) from S(k). Between two steps, a program may change
/// S(k), for example with set_poses(). S(k+1) depends only on the changed S(k), the spec with its seed, the
/// calls of subscribe(), and the changes that the callback of before_tick() makes.
///
/// The functions throw std::logic_error if they are called while they must not be: see Activities. A function
/// that takes a row throws std::out_of_range if there is no such row: see require_row().
class World {
 public:
  /// Builds the world in the state S(0). The registry, from which the world takes its kinds, must outlive the
  /// world. Throws InputError if the spec breaks a rule of check_rules(), and for errors that the loader of a
  /// world file cannot find, such as a controller that needs a sensor which its robot does not have. The
  /// limits of the numbers in the spec are not checked. Throws StepError if a hook `start` of a kind throws.
  /// Adds the warnings of report_overlaps() to `diagnostics`.
  World(WorldSpec spec, const Registry& registry, const WorldOptions& options, Diagnostics& diagnostics);
  World(WorldSpec, Registry&&, const WorldOptions&, Diagnostics&) = delete;
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // ---- Running
  /// Computes one tick: from S(k) to S(k+1). Apart from the first steps, a step allocates no memory unless a
  /// kind or a callback does. Throws StepError for the causes that its docstring lists. Exceptions of the
  /// callbacks of on_phase() and before_tick() propagate unchanged. After any exception the state is
  /// incomplete: see require_whole().
  void step();
  /// Returns to S(0), the state that the constructor or the last call of restart() made, and undoes the
  /// changes of set(). Callbacks and subscriptions stay. Allocates no memory, and may be called while the
  /// state is incomplete. Throws StepError if a hook `start` of a kind throws.
  void reset();
  /// Goes to S(0) with another seed, and with other poses and colours of the bodies. The run then has the
  /// same results as a run of a new world whose spec has this seed and these bodies. Otherwise as reset().
  ///
  /// Throws std::invalid_argument, and changes nothing, if `bodies` has another size than the bodies of the
  /// spec. Throws InputError if the ray grid cannot represent the new static scene, and std::logic_error if a
  /// kind rejects the new bodies; the world is then in the state S(0) with the old seed and bodies.
  ///
  /// bodies     one BodySpec for each body of the spec, in the same order. Only poses and colours may differ
  ///            from the spec; the function does not check this
  /// registry   the registry that was passed to the constructor
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies, const Registry& registry);
  /// Counts that are not part of the state: of work since tick 0, and of changes.
  struct Counters {
    std::uint64_t beams = 0;            ///< rays cast by all sensors
    std::uint64_t conflict_rounds = 0;  ///< rounds of conflict resolution in all ticks: Conflicts::rounds()
    std::uint64_t settings = 0;         ///< changes by set() since the last step
  };
  Counters counters() const;  ///< the present counts
  /// A callback that restore() calls to write a saved state into the tables. It must set every field of every
  /// row. Before the call, restore() sets every byte of the tables to 0.
  using Fill = std::function<void(std::span<StateTable>)>;
  /// Restores a saved state: calls `fill`, checks the filled tables, and recomputes all data that are derived
  /// from them. `tick`, `counters` and `state_hash` are the values of tick(), counters() and Hashes::state
  /// when the state was saved. Returns false, with the world in the state S(0), if the tables do not have the
  /// hash `state_hash`, or if they contain values that no state has, such as a NaN in a pose. If `fill`
  /// throws, the exception propagates, and the world is also in the state S(0).
  bool restore(std::uint64_t tick, const Counters& counters, std::uint64_t state_hash, const Fill& fill);
  /// Replaces the callback that step() calls at the beginning of each phase, with the phase as the argument,
  /// and at the end of the tick, with std::nullopt. An empty callback is not called. If several ranks compute
  /// the world, and the callback throws when the phase `move` begins or later, step() completes the tick
  /// without further calls before it throws the exception.
  void on_phase(Tick::OnPhase callback);
  /// Replaces the callback that each step calls in the phase `intervene`, after it has applied the
  /// interventions and faults of the world file, and before any sensor runs. The callback may change the
  /// world in all ways that are allowed between two steps, but not call step() and before_tick(). If it
  /// replaces the state, for example with reset(), the step continues from the new state: it first applies
  /// the interventions and faults that are due in that state.
  void before_tick(Tick::BeforeTick callback);
  /// Replaces the callback that step() calls in place of a controller, once per batch. It must itself call
  /// controller.kind->decide(controller.data, batch). Several threads call it at the same time. With an empty
  /// callback, step() calls the controllers itself. For ControllerCheck.
  void on_decide(Tick::OnDecide callback) { tick_.on_decide(std::move(callback)); }

  // ---- Rules
  /// Throws std::logic_error if the state is incomplete, because step(), or a hook of a kind in spawn(),
  /// reset() or restart(), has thrown. Some rows may then have the state of the new tick, and others that of
  /// the old tick. reset(), restart() and restore() make it complete again.
  void require_whole() const { activities_.require(Access::read, {}); }
  /// Throws std::logic_error while step() computes a tick: in a callback of on_phase(), and in a hook of a
  /// kind. call: name of the calling function, for the error.
  void require_between_steps(std::string_view call) const { activities_.require(Access::listen, call); }
  /// Throws std::out_of_range if there is no such row: for a Row that is not valid(), such as that of a
  /// static body, and for an index that is too large. call: name of the calling function, for the error.
  void require_row(Row row, std::string_view call) const;
  /// While the result exists, functions that change the world throw, because measures must not change it.
  Activities::During measuring() { return {activities_, Activity::measure}; }

  // ---- Reading
  /// The present state of all bodies. The reference is valid as long as the world exists.
  const CommittedView& view() const { return state_.view; }
  const WorldState& state() const { return state_; }  ///< all data: constants, state, derived data
  /// The spec that the world was made from, with later changes: restart() replaces the seed and the bodies,
  /// and set() adds interventions.
  const WorldSpec& spec() const { return state_.spec; }
  /// Number of completed ticks. During a step, from the phase `sense` on, it is the number of the tick that
  /// the step computes.
  std::uint64_t tick() const { return state_.now.tick; }
  /// All state tables, with the rows of all ranks: see gather(). Throws as require_whole().
  std::span<const StateTable> tables() const;
  const Links& links() const { return links_; }                          ///< joints, and trees of bodies
  const Lives& lives() const { return lives_; }                          ///< reserves, births, deaths
  const Interventions& interventions() const { return interventions_; }  ///< present parameters of types
  std::size_t robots() const;  ///< robots in the world, on all ranks
  Hashes hashes();             ///< hashes of the present state, computed on the worker threads
  /// What measures read. Call gather_distributed() first.
  MeasuredWorld measured() {
    return {*this, state_.view, parallel_, state_.names, places_.placed_before_step()};
  }
  /// Whether the row's body could be placed at a pose (world frame, m and rad). True if its origin would be
  /// within the world's bounds, and the body would overlap neither the static scene nor another body that is
  /// an obstacle. False if the pose is not finite. The test includes the bodies that the row's body carries,
  /// and uses the present poses of its joints; those of an unborn or dead body are at rest. Only the bounds
  /// count if the row's body is carried, or if neither it nor a body that it carries is an obstacle.
  bool is_free(Row row, const Pose& pose) const;
  /// The worker threads of step(). Between steps, other code may use them.
  partition::Parallel& parallel() { return parallel_; }

  // ---- Changes of a program, between two steps or in the callback of before_tick()
  /// Changes parameters of a type, for all its bodies, as the intervention `set` of a world file does. The
  /// change lasts until reset() or restart(). Until then, spec() contains it as an intervention at the
  /// present time. If the parameters cannot change during a run, returns an error that says why, and leaves
  /// the world unchanged. `registry` must be that of the constructor.
  Result<> set(const SettingSpec& setting, const Registry& registry);
  using Placed = engine::Placed;  ///< argument of set_poses(): a row, and a pose for its body
  /// Sets the poses of bodies. Each call rebuilds the spatial index of all bodies, so pass all poses in one
  /// call. If a row occurs twice, its last pose counts. A pose may overlap other bodies. If a body carries
  /// others, they move with it. The bodies are no longer stalled. Velocities and odometry estimates stay.
  /// Throws std::invalid_argument, and moves no body, if a body of the list is carried or not in the world,
  /// or if require_place() rejects a pose.
  void set_poses(std::span<const Placed> placed);
  /// Overwrites the odometry estimate of a robot with a pose, m and rad, in the frame of
  /// CommittedView::estimate(). The z of the pose is ignored, and the heading is wrapped. Throws
  /// std::logic_error if the robot has no odometry or is not in the world, and std::invalid_argument if a
  /// number of the pose, z included, is not finite.
  void set_estimate(Row row, const Pose& pose);
  /// Overwrites the command to the drive of a robot. If a number is not finite, the next step in which the
  /// drive runs throws a StepError.
  void set_command(Row row, const Command& command);
  /// The command struct of a device of the row's body, which the program may change. Throws std::logic_error
  /// if the device takes no commands.
  std::byte* device_command(Row row, const BodyType::Device& device);
  /// Disables or enables a body, as the intervention `disable` or `enable` of a world file does. Returns
  /// false and changes nothing if the body already is as requested, or is not in the world. Enabling a body
  /// does not end a drop-out by a fault. Throws std::logic_error without CommittedView::has_conditions().
  bool set_disabled(Row row, bool disabled);
  /// Spawns the next body of a reserve, an index into WorldSpec::reserves, at a pose, m and rad, world frame.
  /// Apart from its pose and the component `life`, the new body has the state of a body at tick 0. If the
  /// pose is not free (is_free()), or if all bodies of the reserve have been born, no body is born. Throws
  /// std::out_of_range if the reserve does not exist, std::invalid_argument if the pose is not finite, and
  /// StepError if a hook `start` of a kind throws. Each birth rebuilds the spatial index of all bodies.
  Birth spawn(std::size_t reserve, const Pose& pose);
  /// Removes a body from the world. Bodies that it carries stay where they are. Does nothing if the body is
  /// not in the world. Throws std::logic_error without CommittedView::has_lives(). Each call rebuilds the
  /// spatial index of all bodies.
  void remove(Row row);
  /// Makes every sensor and every other device of a body run, including those that no controller uses. Throws
  /// std::out_of_range if there is no such body, or if it has no row. Call this before the first step.
  void subscribe(BodyId body);
  /// Lets each later step find out what blocks bodies, for CommittedView::contact(). The state and its hashes
  /// do not change.
  void watch_contacts();

  // ---- Rows
  /// Removes the rows of bodies from this world. Returns their data, in the order of `bodies`. add_rows() can
  /// add the rows again, to this World or to another World that was made from the same spec. Throws
  /// std::invalid_argument as Rows::take(), and std::logic_error if several ranks compute the world.
  ///
  /// If why_replicated() (engine/ranks/halo.hpp) returns an empty text, step() may be called before
  /// add_rows(): the remaining bodies do what they would do if the removed bodies were far away, except that
  /// an intervention that chooses bodies at random chooses among the remaining bodies only. In any other
  /// world, add_rows() must add the rows again before any other call. All lists with one element per row may
  /// move in memory, here, in add_rows() and, if the rows are distributed among ranks, in gather().
  std::vector<RowState> remove_rows(std::span<const BodyId> bodies);
  /// Adds rows that remove_rows() has removed, in any order. Throws as Rows::add().
  void add_rows(std::span<const RowState> added);

  // ---- Ranks
  /// Attaches the ranks that compute this world; null: removes them. Calls Ranks::join().
  void attach(Ranks* ranks);
  /// Completes the state tables on rank 0 with the rows that only other ranks have computed. Functions that
  /// read whole tables call gather() first. Before several threads read the world at the same time, call
  /// gather() on the thread that calls step(). Does nothing if the tables are already complete, if this is
  /// not rank 0, and while a tick is computed.
  void gather() const { ranks_->gather(); }
  /// Calls gather() if the rows of the world are distributed among the ranks: rank 0 then has all rows until
  /// the next step. If they are not, every rank already has the poses of all bodies. Code that reads the
  /// poses of all bodies, such as a measure, calls this function first.
  void gather_distributed() const { ranks_->gather_distributed(); }

  // ---- For tests
  /// Overwrites all derived data with junk, and then computes them again. A test then checks that the run
  /// continues with the same hashes (the "amnesia" test, docs/determinism.md).
  void forget();
  /// Switches a mode on or off that finds kinds of devices which read or change data of other bodies without
  /// having declared it: see Blinkers. Slow. Throws std::invalid_argument if the mode is switched on in a
  /// world with several threads or a ray grid.
  void hide_beyond_reach(bool on);
  /// Gives the bodies other rows and slots, at random: see Rows::shuffle(). No result depends on them. Throws
  /// std::logic_error if several ranks compute the world.
  void shuffle_rows(std::uint64_t seed);

 private:
  [[noreturn]] void throw_no_row(Row row, std::string_view call) const;
  /// Checks and prepares a call that changes rows. `what` names the change in the error text.
  void begin_row_change(std::string_view what) const;
  void build_scene();
  void build_tables();
  /// Fills the tables with the state at tick 0, and computes all derived data.
  void start();
  /// Called when a program is about to change the state, so that the other ranks receive the changed state
  /// before the next tick. Does nothing during a tick.
  void touch();

  WorldState state_;
  partition::Parallel parallel_;
  RankPort ranks_;
  Activities activities_{state_.now.tick};
  Links links_{state_, parallel_};
  Movement movement_{state_, parallel_};
  Places places_{state_, parallel_, links_, movement_};
  Rows rows_{state_, places_};
  Lives lives_{state_, links_, movement_, places_, ranks_};
  Interventions interventions_{state_, movement_, places_, lives_, ranks_};
  Tick tick_{{state_, parallel_, links_, movement_, places_, lives_, interventions_, ranks_, activities_}};
  Derivation derivation_{state_, links_, movement_, places_, lives_, interventions_, tick_};
  RankAccess access_{state_,         movement_, links_,      rows_,      lives_,
                     interventions_, tick_,     derivation_, activities_};
};

/// The world that a measure reads, for measures in another language, which read it through the public
/// interface. While measures are computed, they cannot change it (World::measuring()).
inline World& whole_world(const MeasuredWorld& measured) { return measured.world_; }

}  // namespace troupe::engine
