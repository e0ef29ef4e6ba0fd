#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "engine/act.hpp"
#include "engine/energy.hpp"
#include "engine/phase.hpp"
#include "engine/ranging_engine.hpp"
#include "engine/state_table.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe {
class Diagnostics;
class SourceFiles;
}  // namespace troupe
namespace troupe::engine {
class World;
struct BodySpec;
struct Registry;
struct WorldSpec;
enum class ControlMode : std::uint8_t;
}  // namespace troupe::engine
namespace troupe::worldio {
struct LoadOptions;
struct WorldDocument;
}  // namespace troupe::worldio

namespace troupe {

/// How ranges are computed: by exact geometry, or by a walk through a grid of cells (docs/sensing.md).
using engine::RangingEngine;

/// How a world is loaded and run. Only `seed`, `ranging`, `robots`, `set` and `spare` change results.
struct SimulationOptions {
  /// Worker threads, at most 1,024. 0: one per processor that the process may use, by its affinity mask and
  /// its control groups. More than 1,024 throw std::invalid_argument.
  unsigned threads = 0;
  /// Edge of the tiles that are the unit of parallel work, m. 0: chosen from body sizes and sensor ranges.
  double tile_size_m = 0;
  /// Replaces the world's seed.
  std::optional<std::uint64_t> seed;
  /// Replaces the world's ranging engine.
  std::optional<RangingEngine> ranging;
  /// Population sizes: name -> count; an empty name means the world's only population.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// JSON pointer -> value ("/populations/0/count" -> "500").
  std::vector<std::pair<std::string, std::string>> set;
  /// Directories in which worlds and includes are searched by base name if their own path does not exist.
  std::vector<std::filesystem::path> search_path;
  /// Directories searched for plug-ins: controllers and sensors that Troupe does not ship
  /// (docs/controllers.md).
  std::vector<std::filesystem::path> plugin_path;
  /// Lets the program remove, disable and enable bodies, as `"mortal": true` in the world does. The hash
  /// stays the same while every body of tick 0 is alive and enabled.
  bool mortal = false;
  /// Adds a reserve of this many bodies to each population of robots without one, after all other bodies, so
  /// that spawn() can add robots to a running world (docs/lives.md). A world with a reserve has other hashes.
  std::uint32_t spare = 0;
};

/// How a saved run is resumed. Only `set` changes results.
struct ResumeOptions {
  /// Worker threads, as in SimulationOptions.
  unsigned threads = 0;
  double tile_size_m = 0;  ///< edge of the tiles, m, as in SimulationOptions
  /// JSON pointer into the checkpoint's /world -> value ("/types/1/drive/params/velocity_max_x_mps" ->
  /// "0.5"), for values that keep the shape of the state (docs/checkpoints.md lists them). The resumed run
  /// then differs from the original.
  std::vector<std::pair<std::string, std::string>> set;
  /// Accepts a checkpoint of another version of Troupe. The results may then differ in their bits from those
  /// of the version that wrote it.
  bool across_versions = false;
  /// Directories searched for plug-ins, as in SimulationOptions; must contain the plug-ins of the run.
  std::vector<std::filesystem::path> plugin_path;
  /// Accepts plug-ins of another build than those that the checkpoint was written with.
  bool across_plugins = false;
};

/// The phases of a tick, in order: engine/phase.hpp.
using engine::k_phases;
using engine::Phase;
using engine::phase_name;

/// Counters of a run since tick 0.
struct Statistics {
  std::size_t robots = 0;             ///< robots in the world
  std::uint64_t ticks = 0;            ///< completed ticks
  double time_s = 0;                  ///< world time, s
  std::uint64_t beams = 0;            ///< rays cast by sensors
  std::size_t stalled = 0;            ///< robots whose last motion was blocked
  std::size_t held_at_bounds = 0;     ///< robots whose last motion was out of bounds
  double mean_displacement_m = 0;     ///< mean straight-line distance of robots from their start or birth, m
  std::uint64_t conflict_rounds = 0;  ///< rounds of conflict resolution, summed over all ticks
  std::size_t state_bytes = 0;        ///< size of all state tables
};

class Recording;
class Simulation;
class Swarm;
class WorldBuilder;
struct PictureOptions;
struct RecordingOptions;

/// A handle of one model of a simulation: a body, or a part of one. Cheap to copy; valid while the simulation
/// lives.
class Model {
 public:
  const std::string& name() const;  ///< from the world, or the one that Stage would generate
  /// Id of its body, as fiducial finders, bumpers, radios and cast() report it and Simulation::model() takes
  /// it.
  BodyId id() const;
  /// Global pose, m and rad. A part on a joint is where the joint has moved it. Of a dead body: its last
  /// pose; of an unborn one: NaN.
  Pose pose() const;
  /// Size as declared in the world, m.
  Eigen::Vector3d size() const;
  /// Commands speeds: forward and left in m/s, turn in rad/s (for a car: the steering angle, rad). They take
  /// effect from the next tick on, within the limits of the drive, until replaced. A controller of the robot
  /// overrides them. Throws std::logic_error, as all commands do, for a model that has no drive or is not in
  /// the world.
  void set_speed(double forward, double left, double turn);
  void set_speed(double forward, double turn) { set_speed(forward, 0, turn); }  ///< with `left` = 0
  /// Commands accelerations: m/s^2 and rad/s^2 (for a car `turn` is the steering angle, rad). They take
  /// effect from the next tick on, within the drive's limits of acceleration and speed, until replaced.
  void accelerate(double forward, double left, double turn);
  void accelerate(double forward, double turn) { accelerate(forward, 0, turn); }  ///< with `left` = 0
  /// Commands a pose in the frame of estimate(), m and rad: the robot drives there and stays until the
  /// command is replaced. docs/driving.md describes the path of each drive.
  void go_to(double x, double y, double heading);
  void go_to(const Pose& goal) { go_to(goal.x, goal.y, goal.heading); }  ///< ignores goal.z
  /// Velocity of the last tick, body frame.
  struct Speed {
    double forward = 0;  ///< m/s
    double left = 0;     ///< m/s
    double turn = 0;     ///< rad/s
  };
  Speed speed() const;  ///< velocity of the last tick, body frame
  /// Whether it is in the world: born and not dead (docs/lives.md).
  bool is_alive() const;
  /// Whether its last motion was blocked.
  bool stalled() const;
  /// Estimated pose, m and rad: with localization `gps` the true global pose; with `odom` the odometry
  /// estimate, in the frame of the world's localization_origin.
  Pose estimate() const;
  /// Overwrites the odometry estimate. Throws std::logic_error if the robot has no `odom`.
  void set_estimate(const Pose& pose);

  /// Moves it to a pose in the world's frame, between two steps. This is not a motion: odometry does not
  /// measure it, the speed stays, a stall ends, and sensors see it from the next step on. What the model
  /// carries moves with it. The place need not be free (is_free() tells): the model may leave bodies that it
  /// then overlaps, but not move deeper into them. Throws std::invalid_argument for a pose that is not finite
  /// or is out of bounds, and for a carried body; std::logic_error for a part of a model, for static
  /// geometry, and within Swarm::for_each(), like every function that changes more than one robot. To move
  /// many models at once, see Simulation::set_poses().
  void set_pose(const Pose& pose);
  /// Whether it would fit at this pose: within the world's bounds, and touching no wall and no other body.
  bool is_free(const Pose& pose) const;

  /// The random stream of this robot, name and tick, for a program that drives the robot; use one name per
  /// purpose. A function of the seed, the name, the robot and the tick alone: a second call returns the same
  /// numbers.
  Random random(std::string_view name) const;

  /// Names of its sensors, in the order of the world: those of all parts of a robot, or those of one part.
  std::vector<std::string> sensors() const;
  /// Readings of a ranger, m, one per beam, counter-clockwise within each transducer. Empty `sensor`: the
  /// first sensor. The span stays valid and shows new readings after each step. Throws std::out_of_range,
  /// with the known names, if there is no such sensor, and std::logic_error if it does not run (subscribe
  /// first).
  std::span<const float> ranges(std::string_view sensor = {}) const;
  /// Intensities, one per value of ranges(). Empty unless the ranger has `intensity` switched on.
  std::span<const float> intensities(std::string_view sensor = {}) const;
  /// Readings of a sensor or another device of any kind:
  ///
  ///     robot.readings<float>("depth");             // depth image of its camera, m, one value per pixel
  ///     robot.readings<std::int32_t>("id", "eye");  // of the fiducial finder "eye"
  ///
  /// field   its name; docs/library.md lists the fields of all kinds, fields() those of one device
  /// device  its name; empty: the first device that has this field
  /// shape   the columns of the field, in its unit. The span stays valid and shows new readings after each
  ///         step
  /// errors  std::out_of_range, with the known names, for an unknown field or device; std::logic_error for a
  ///         sensor that does not run; std::invalid_argument if T is not the element type of the field
  template <class T>
  std::span<const T> readings(std::string_view field, std::string_view device = {}) const {
    const std::span<const std::byte> bytes = cell(field, device, engine::element_of<T>());
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// One field of a device as bytes, for callers that learn its element type at run time.
  struct Reading {
    std::string_view device;                    ///< its name; lives as long as the simulation
    const engine::StateField* field = nullptr;  ///< element type, columns, unit; lives as long as `device`
    std::span<const std::byte> bytes;           ///< all columns
  };
  Reading reading(std::string_view field, std::string_view device = {}) const;  ///< throws as readings() does
  /// The fields that readings() can return of a device: names, element types, columns, units. Throws
  /// std::out_of_range, with the known names, if there is no such device.
  std::span<const engine::StateField> fields(std::string_view device) const;
  /// The command of a device, to be written between two steps; it takes effect from the next step on. Command
  /// is the command struct of the kind (models::GripperCommand, models::LedCommand, ...). Empty `device`: the
  /// first device that takes this struct. A controller that uses the device overrides the command. Throws
  /// std::out_of_range, with the known names, if there is no such device, and std::invalid_argument if its
  /// command has other field names (TROUPE_FIELDS) or another size.
  template <class Command>
  Command& command(std::string_view device = {}) {
    return *reinterpret_cast<Command*>(asked(device, sizeof(Command), Command::troupe_field_names()));
  }
  /// The command of a device as bytes, for callers that learn its fields at run time.
  struct Asked {
    std::span<const engine::StateField> fields;  ///< with their offsets in `bytes`
    std::span<std::byte> bytes;                  ///< the command struct of the kind
  };
  Asked asked(std::string_view device);  ///< throws std::out_of_range if no such device takes commands

  /// Charge of a power pack, and energy that passed through it since tick 0, J (docs/energy.md).
  using Energy = engine::Energy;
  /// Energy of the power pack that supplies it: its own, or else that of the nearest part below it. Empty if
  /// there is none.
  std::optional<Energy> energy() const;
  /// Number of flags that this part itself holds, without the parts on it; 0 if it cannot hold flags.
  std::size_t flag_count() const;

 private:
  friend class Simulation;
  friend class Swarm;
  struct Place;
  explicit Model(std::shared_ptr<const Place> place);
  static Model of(engine::World& world, BodyId body);
  std::span<const std::byte> cell(std::string_view field, std::string_view device,
                                  engine::Element element) const;
  std::byte* asked(std::string_view device, std::size_t bytes, std::string_view fields);
  /// Marks the robot that Swarm::for_each() visits on this thread.
  class Visit {
   public:
    explicit Visit(const Model& robot);
    ~Visit();
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    const Model* before_;
  };
  static void refuse_in_for_each(const engine::World& world, std::string_view what);
  void refuse_others_in_for_each() const;
  void command(engine::ControlMode mode, double x, double y, double turn);
  std::shared_ptr<const Place> place_;
};

/// The first surface that a ray meets.
struct RayHit {
  double range_m = 0;      ///< distance to the surface, m; the length of the ray if it met nothing
  BodyId body;             ///< the body, for Simulation::model(); not valid if the ray met nothing
  std::uint32_t part = 0;  ///< index in the parts of the body's type; 0: the root

  bool met() const { return body.valid(); }  ///< whether the ray met a surface
};

/// A world and its state. Not thread-safe: call it from one thread. It runs on `threads` workers of its own.
/// Several simulations may live in one process.
class Simulation {
 public:
  /// Loads a world file (Stage `.world` or Troupe JSON). Throws InputError that lists all errors in it, each
  /// as `file:line: error: ...`.
  explicit Simulation(const std::filesystem::path& world, const SimulationOptions& options = {});
  /// Loads a world file with additional kinds: `registry` is make_registry() (troupe/registry.hpp) plus the
  /// kinds of the caller.
  Simulation(const std::filesystem::path& world, const SimulationOptions& options, engine::Registry registry);
  /// Loads a world from its text. `name` stands for the file: its ending, .world or .json, selects the
  /// syntax, relative paths are resolved from its folder, and errors read `name:line: error: ...`.
  static Simulation from_text(std::string text, const std::filesystem::path& name,
                              const SimulationOptions& options = {});
  /// Loads a world from its text, with additional kinds.
  static Simulation from_text(std::string text, const std::filesystem::path& name,
                              const SimulationOptions& options, engine::Registry registry);
  /// Makes a world that a program described (troupe/world_builder.hpp). Throws as from_text() does; lines are
  /// those of WorldBuilder::json().
  explicit Simulation(const WorldBuilder& world, const SimulationOptions& options = {});
  /// Makes a world that a program described, with additional kinds.
  Simulation(const WorldBuilder& world, const SimulationOptions& options, engine::Registry registry);
  /// Makes a world from a document: the content of a JSON world file as plain data
  /// (worldio/json/world_document.hpp). `name` stands for the file, as in from_text(). Throws as from_text()
  /// does, at the places that the document states.
  explicit Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name = "world.json",
                      const SimulationOptions& options = {});
  /// Makes a world from a document, with additional kinds.
  Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
             const SimulationOptions& options, engine::Registry registry);
  /// Makes a world from a spec (engine/world_spec.hpp) that a program or a loader filled. Throws InputError
  /// that lists all invalid values, each by its path and, if the spec has them, file and line:
  /// `types[0].parts[2].size: must be ..., found nan`. The options `robots`, `set` and `search_path` are for
  /// files and throw std::invalid_argument here.
  explicit Simulation(engine::WorldSpec world, const SimulationOptions& options = {});
  /// Makes a world from a spec, with additional kinds.
  Simulation(engine::WorldSpec world, const SimulationOptions& options, engine::Registry registry);
  /// Resumes a run from a checkpoint of save() or `troupe run --checkpoint`: with the same bits as if it had
  /// never stopped, on any number of threads, and without the files that its world was loaded from. Throws
  /// InputError, `run.h5: error: ...`, for a file that is not a checkpoint, is truncated or damaged, or comes
  /// from a newer version.
  static Simulation resume(const std::filesystem::path& checkpoint, const ResumeOptions& options = {});
  /// Resumes a run of a world that was loaded with additional kinds.
  static Simulation resume(const std::filesystem::path& checkpoint, const ResumeOptions& options,
                           engine::Registry registry);
  ~Simulation();
  Simulation(Simulation&&) noexcept;  ///< handles stay valid; the source may only be destroyed or assigned
  Simulation& operator=(
      Simulation&&) noexcept;  ///< handles stay valid; the source may only be destroyed or assigned

  /// Warnings of the loader, `file:line: warning: ...`, and of plug-ins, `file: warning: ...`.
  const std::vector<std::string>& warnings() const;
  /// The options in effect, as key and value, for logs.
  std::vector<std::pair<std::string, std::string>> effective_options() const;

  /// The condition of the world's `stop_when` that holds, as `coverage >= 0.9`: the run is over
  /// (docs/experiments.md). Conditions are evaluated after each step, and once when a run is resumed; the
  /// result is empty before the first step.
  std::optional<std::string> stopped() const;

  /// Advances the world by one tick: intervene, sense, actuate, decide, move, index; also after the run is
  /// over. Throws engine::StepError, a std::runtime_error that names tick and robot, if a commanded speed is
  /// not finite or if a controller or a device throws. An exception of an on_phase() callback passes through
  /// unchanged. After an exception the state is incomplete: until reset() every function of the simulation,
  /// its models, swarms and observers that reads or continues the state throws std::logic_error.
  void step();
  /// Steps until `seconds` more of world time have passed, rounded up to whole ticks, or the run is over
  /// (stopped()). Throws std::invalid_argument if `seconds` is negative, NaN or more than 1e12.
  void run_for(double seconds);
  /// Steps until `done`, called after each step, returns true; then returns true. Returns false if
  /// `at_most_s` seconds of world time pass, or the run is over, first. Throws std::invalid_argument as
  /// run_for() does.
  bool run_until(const std::function<bool(const Simulation&)>& done, double at_most_s);
  /// Adds a callback that is called at the end of every step, also of steps of run_for() and run_until().
  /// Callbacks run in the order in which they were added, after stopped() is evaluated and record() has
  /// written, so they see the state that the step left. They may do what a program may do between two steps
  /// (read, command, set_poses(), spawn(), remove(), save()), but step(), reset() and on_tick() throw
  /// std::logic_error. An exception leaves step() with the tick complete, and the remaining callbacks are not
  /// called. Null removes all callbacks.
  void on_tick(std::function<void(Simulation&)> callback);
  /// Sets a callback that is called in every step after the world's own events (`at`, faults) and before the
  /// tick begins. It may do what a program may do between two steps, and act(), but not step() or reset(). An
  /// exception leaves step() with an incomplete state. Null removes it.
  void before_tick(std::function<void(Simulation&)> callback);
  /// Applies an act of a user to a running world (docs/live.md): between two steps, or in before_tick(),
  /// where it comes after the world's own events. A hold lasts until it is released, is saved in checkpoints,
  /// and ends with reset(). Throws ActRefused (troupe/acts.hpp), and changes nothing, if the act is
  /// impossible.
  void act(const engine::Act& act);
  /// Returns to the state after loading, bit for bit: tick 0, the same hashes, then the same run. Handles,
  /// callbacks and subscriptions stay; commanded speeds do not. A recording of record() is closed. Also
  /// recovers from a step that threw. Reads no file and allocates nothing, so thousands of trials of one
  /// world cost only their steps; but the conditions of `stop_when` restart, which allocates.
  void reset();
  /// Returns to the state that the world has after loading with another seed, bit for bit: populations are
  /// placed again, and every draw follows the new seed. Otherwise as reset(), but it allocates. Throws
  /// InputError, and changes nothing, if the populations find no place with this seed; std::logic_error for a
  /// resumed run, because a checkpoint does not store how bodies were placed.
  void reset(std::uint64_t seed);
  /// Makes another simulation of the same world at tick 0, as if it had been loaded with this seed. Reads no
  /// file, and shares kinds and plug-ins with this one, which it may outlive. Callbacks and subscriptions are
  /// not copied. threads: as in SimulationOptions. Throws as reset(seed) does.
  Simulation another(std::uint64_t seed, unsigned threads) const;

  /// Saves the whole state, between two steps, in one HDF5 file for resume(), which then needs neither the
  /// world's file nor its bitmaps. The file is written under a temporary name and renamed once it is complete
  /// and on the disk: if the process dies, the name holds the previous checkpoint or the new one. Callbacks
  /// are not saved; subscriptions and commanded speeds are. Throws std::runtime_error, `run.h5: error: ...`,
  /// if the file cannot be written or the build has no HDF5; the previous checkpoint then remains.
  void save(const std::filesystem::path& checkpoint) const;

  /// Saves the memory of an observer with the state: each save() calls `memory` and stores its bytes in the
  /// checkpoint under `name`. Null removes it.
  void on_save(const std::string& name, std::function<std::vector<std::byte>()> memory);
  /// The bytes stored under `name` in the checkpoint that the run was resumed from; empty if there are none.
  std::optional<std::vector<std::byte>> saved_memory(const std::string& name) const;

  /// The tick of the checkpoint that the run was resumed from; empty if it was not resumed.
  std::optional<std::uint64_t> resumed_at_tick() const;

  double time_s() const;       ///< world time, s
  std::uint64_t tick() const;  ///< number of completed ticks
  double tick_s() const;       ///< length of a tick, s
  /// Number of robots in the world.
  std::size_t robots() const;
  std::uint64_t seed() const;  ///< seed of all random draws
  std::string title() const;   ///< title of the world, or else the name of its file
  /// The `quit_time_s` of the world, s; empty if it has none.
  std::optional<double> quit_time_s() const;

  /// Finds a model by name: a body, or a part below it ("r0.ranger:1"), by its name in the world or the one
  /// that Stage would generate. Throws std::out_of_range, with similar names, if there is none.
  Model find(std::string_view name);
  /// The body with this id, as sensors and cast() report it. Throws std::out_of_range if there is none.
  Model model(BodyId id);
  /// The first surface along a ray, by exact geometry, also in worlds that use the grid engine.
  /// from       start, m, and direction, rad, in the world frame; the ray stays at the height from.z
  /// range_max  m; surfaces at this distance or beyond are not met
  /// without    a model that the ray ignores, with everything that it carries: for rays from within a robot
  /// meets      what rangers meet (ranger_return >= 0), if the closed z interval holds the height, from both
  ///            sides; computed in doubles, so it may differ from a reading in the last bits of a float
  /// ties       of two surfaces at one distance, the lower (id, part)
  /// errors     std::invalid_argument for a pose that is not finite, and a range below 0 or beyond 300 km
  /// cost       one walk along the ray. Changes nothing: several threads may cast at once, between two steps
  RayHit cast(const Pose& from, double range_max, const Model* without = nullptr) const;
  /// A group of robots (troupe/swarm.hpp), in the order of their ids: those of the type or the population of
  /// this name, or one robot; empty: all robots. Throws std::out_of_range, with the known names, for an
  /// unknown name.
  Swarm swarm(std::string_view of = {});
  /// Model::set_pose() for many models at little more than the cost of one, because bodies are indexed once.
  /// If one pose is invalid, no model is moved.
  void set_poses(std::span<const std::pair<Model, Pose>> poses);
  /// Spawns the next body of a population's reserve, between two steps, at a pose in the world's frame, m and
  /// rad. Sensors see it from the next step on, in which its life begins as that of other bodies at tick 0.
  /// Returns nothing if the place is out of bounds or touches a solid body, or if the reserve is used up.
  /// Throws std::out_of_range for a population without a reserve, and std::invalid_argument for a pose that
  /// is not finite. Costs the indexing of all bodies.
  std::optional<Model> spawn(std::string_view population, const Pose& pose);
  /// Number of bodies of a population's reserve that are not yet born.
  std::size_t unborn(std::string_view population) const;
  /// Removes a body for good, between two steps: nothing meets or senses it any more, bodies that it carried
  /// lie where they were, and its id is never used again. Does nothing for a body that is not in the world.
  /// Throws std::logic_error for a part of a model, for static geometry, and in a world without a reserve and
  /// without `"mortal": true`. Costs the indexing of all bodies.
  void remove(const Model& model);
  /// Disables a body, between two steps: its controllers, drive, sensors and other devices stop; sensors keep
  /// their readings. The body stays where it is, and others still meet and sense it. Returns false if it is
  /// disabled already or not in the world. Throws std::logic_error for a part of a model, for static
  /// geometry, and in a world without faults, without `disable` in its `at` and without `"mortal": true`.
  bool disable(const Model& model);
  /// Enables a disabled body: it continues with its last commands. Returns false if it is not disabled.
  /// Throws as disable() does.
  bool enable(const Model& model);
  /// Names of all robots in the world, in the order of their ids.
  std::vector<std::string> robot_names() const;
  /// Runs every sensor of a robot, as Stage's Subscribe does. Call it before the first step.
  void subscribe(std::string_view model);

  /// Records this run from now on (troupe/recording.hpp): the current state, and then each step whose tick is
  /// due, until stop_recording(), reset() or the end of this object. Throws as Recording does, and
  /// std::logic_error if it records already.
  void record(const std::filesystem::path& file);
  void record(const std::filesystem::path& file, const RecordingOptions& options);  ///< records, with options
  /// Closes the recording; other HDF5 tools can then read the file. Throws std::runtime_error if that fails;
  /// does nothing if nothing is recorded.
  void stop_recording();

  /// Hash of the whole state (docs/determinism.md).
  std::uint64_t state_hash() const;
  /// The hash of the state, and its parts by group.
  struct Hashes {
    std::uint64_t state = 0;     ///< the sum of the others, modulo 2^64
    std::uint64_t pose = 0;      ///< poses, which body carries which, which bodies are alive
    std::uint64_t velocity = 0;  ///< velocities, commands of drives and devices, stalls
    std::uint64_t sensor = 0;    ///< readings, and the state of other devices
    std::uint64_t memory = 0;    ///< memory of controllers, odometry, faults and disabled bodies
  };
  Hashes hashes() const;  ///< hashes of the current state
  /// First lines of a hash log: `# key: value` each. Logs of equal runs may differ in them.
  std::string hash_log_header() const;
  /// One line of a hash log: `tick state pose=... velocity=... sensor=... memory=...`.
  std::string hash_log_line() const;

  Statistics statistics() const;  ///< counters since tick 0; visits every robot
  /// The sums over all power packs of the world; `infinite` and `charging` are true if they are for any pack.
  Model::Energy energy() const;
  unsigned threads() const;  ///< number of worker threads
  /// Sets a callback for timing that is called as each phase begins, and with no phase as the tick ends.
  void on_phase(std::function<void(std::optional<Phase>)> callback);
  /// Sets a callback for profiles that is called as each task of a parallel loop begins (true) and ends
  /// (false), with the index of the task in its loop. Workers call it concurrently: it must be thread-safe.
  /// Set it between steps.
  void on_task(std::function<void(std::size_t task, bool begins)> callback);
  /// Sets a callback for timing that is called on the stepping thread as each parallel loop begins (true) and
  /// ends (false), also for loops between steps (hashes, measures). Set it between steps.
  void on_loop(std::function<void(bool begins)> callback);

  /// The engine's view of the world (engine/world.hpp): types, state tables and hooks, for tools that compare
  /// or save states of any kind. Lives as long as the simulation.
  engine::World& world();
  const engine::World& world() const;  ///< the engine's view of the world, to read
  /// The kinds that the world was made of. Lives as long as the simulation.
  const engine::Registry& registry() const;

  /// Draws the world from above into a PNG file. Throws std::runtime_error if OSMesa is missing, the build
  /// has no renderer, or the file cannot be written.
  void snapshot(const std::filesystem::path& png, int width = 1280, int height = 720) const;
  /// Draws the world as `options` say (troupe/pictures.hpp): camera, size, layers. Throws also InputError for
  /// options that name something that the world does not have.
  void snapshot(const std::filesystem::path& png, const PictureOptions& options) const;
  /// A picture of the world from above in memory: 8-bit RGB, three bytes per pixel, row 0 on top. Throws as
  /// snapshot() does, and std::invalid_argument for a size below 1. The renderer is kept for later calls with
  /// the same options, so do not call these functions from two threads at once.
  std::vector<std::uint8_t> picture(int width = 1280, int height = 720) const;
  /// A picture as `options` say, in memory. Throws also std::invalid_argument for a transparent background.
  std::vector<std::uint8_t> picture(const PictureOptions& options) const;

 private:
  friend class Model;
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::vector<engine::BodySpec> bodies_placed_by(std::uint64_t seed, std::string_view call) const;
  using ReadWorld = std::function<engine::WorldSpec(const engine::Registry& registry,
                                                    const worldio::LoadOptions& options, Diagnostics& found)>;
  static Simulation load(const std::filesystem::path& file, const SimulationOptions& options,
                         engine::Registry registry, std::shared_ptr<SourceFiles> files,
                         const ReadWorld& read);
  static Simulation make(engine::WorldSpec world, const SimulationOptions& options,
                         engine::Registry registry);
  std::size_t reserve_of(std::string_view population) const;
  bool set_disabled(const Model& model, bool disabled);
  std::unique_ptr<Impl> impl_;
};

/// Version, compiler, flags, instruction set and assertion state, on one line.
std::string version_line();

}  // namespace troupe
