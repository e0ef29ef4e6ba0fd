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

/// What finds ranges: exact geometry, or a walk through cells (docs/sensing.md).
using engine::RangingEngine;

/// How a world is loaded and run. Nothing here but `seed`, `ranging`, `robots`, `set` and `spare`
/// changes a result.
struct SimulationOptions {
  /// Worker threads, at most 1,024; 0: one for each processor that the process may use, by its affinity mask
  /// and its control groups. More throw std::invalid_argument.
  unsigned threads = 0;
  /// Edge of the tiles that are the unit of parallel work, m; 0: chosen from body sizes and sensor ranges.
  double tile_size_m = 0;
  /// Replaces the world's seed.
  std::optional<std::uint64_t> seed;
  /// Replaces the world's ray engine.
  std::optional<RangingEngine> ranging;
  /// Population sizes: name -> count; an empty name means the world's only population.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// JSON pointer -> value ("/populations/0/count" -> "500").
  std::vector<std::pair<std::string, std::string>> set;
  /// Directories searched, by base name, for worlds and includes that are not where they were said to be.
  std::vector<std::filesystem::path> search_path;
  /// Directories searched for plug-ins with the controllers and sensors that Troupe has not
  /// (docs/controllers.md).
  std::vector<std::filesystem::path> plugin_path;
  /// Programs may remove, disable and enable bodies of any world, as if it said `"mortal": true`. Bodies that
  /// are there from the start, and sound, add nothing to the hash for it.
  bool mortal = false;
  /// So many bodies of each population of robots without a reserve may be added while the world runs: a
  /// reserve, behind all other bodies (docs/lives.md). A world with one has other hashes.
  std::uint32_t spare = 0;
};

/// How a saved run goes on. Nothing here but `set` changes a result.
struct ResumeOptions {
  /// As in SimulationOptions.
  unsigned threads = 0;
  double tile_size_m = 0;  ///< as there
  /// JSON pointer into the checkpoint's /world -> value ("/types/1/drive/params/velocity_max_x_mps" ->
  /// "0.5"), for what keeps the shape of the state (docs/checkpoints.md lists it): the run goes on as
  /// another one from here.
  std::vector<std::pair<std::string, std::string>> set;
  /// Takes a checkpoint of another version of Troupe, which may go on with other bits than the version that
  /// made it.
  bool across_versions = false;
  /// As in SimulationOptions; the run's plug-ins must be on it.
  std::vector<std::filesystem::path> plugin_path;
  /// Takes other builds of the plug-ins than those with which the checkpoint was made.
  bool across_plugins = false;
};

/// The phases of a tick, in their order: engine/phase.hpp.
using engine::k_phases;
using engine::Phase;
using engine::phase_name;

/// Counters of a run, since tick 0.
struct Statistics {
  std::size_t robots = 0;             ///< that are in the world
  std::uint64_t ticks = 0;            ///< made
  double time_s = 0;                  ///< on the world's clock
  std::uint64_t beams = 0;            ///< rays cast, counted where they are cast
  std::size_t stalled = 0;            ///< robots whose last motion was refused
  std::size_t held_at_bounds = 0;     ///< robots whose last motion would have left the world
  double mean_displacement_m = 0;     ///< of robots, straight from where they started, or were born
  std::uint64_t conflict_rounds = 0;  ///< rounds in which motions were settled, all ticks together
  std::size_t state_bytes = 0;        ///< of all state tables
};

class Recording;
class Simulation;
class Swarm;
class WorldBuilder;
struct PictureOptions;
struct RecordingOptions;

/// A model of a simulation, found by its name. A light handle: valid while its simulation lives.
class Model {
 public:
  const std::string& name() const;  ///< as the world gives it, or as Stage would
  /// Of its body: what fiducial finders, bumpers, radios and cast() tell of who was met, and what
  /// Simulation::model() takes.
  BodyId id() const;
  /// Global pose, m and rad; of a part of a body where the joint that it stands on has carried it. Of a body
  /// that died: where that was; of one not born yet: not a number.
  Pose pose() const;
  /// Extent as declared in the world, m.
  Eigen::Vector3d size() const;
  /// Commanded speeds: forward and left in m/s, turn in rad/s (the steering angle in rad for a car). They act
  /// from the next tick on, within the drive's bounds, until replaced; a controller of the robot overrides
  /// them. Throws std::logic_error for one without a drive, or that is not in the world, as do all commands.
  void set_speed(double forward, double left, double turn);
  void set_speed(double forward, double turn) { set_speed(forward, 0, turn); }  ///< the same
  /// Lets its speeds grow: m/s^2 and rad/s^2 (for a car `turn` is the steering angle, rad), from the next
  /// tick on, within the drive's bounds of acceleration and speed, until replaced.
  void accelerate(double forward, double left, double turn);
  void accelerate(double forward, double turn) { accelerate(forward, 0, turn); }  ///< the same
  /// Sends it to a pose in the frame of estimate(), m and rad, where it stays until replaced. How each drive
  /// goes there: docs/driving.md.
  void go_to(double x, double y, double heading);
  void go_to(const Pose& goal) { go_to(goal.x, goal.y, goal.heading); }  ///< the same
  /// Velocity of the last tick, body frame.
  struct Speed {
    double forward = 0;  ///< m/s
    double left = 0;     ///< m/s
    double turn = 0;     ///< rad/s
  };
  Speed speed() const;  ///< of the last tick
  /// Whether it is in the world: born, where it was not there from the start, and not dead. docs/lives.md.
  bool is_alive() const;
  /// True when the last motion was refused.
  bool stalled() const;
  /// Estimated pose, m and rad: its true pose with localization `gps`, what its wheels counted with
  /// `odom`, in the frame of the world's localization_origin.
  Pose estimate() const;
  /// Overwrites the odometry estimate. Throws std::logic_error if the robot has no odometry.
  void set_estimate(const Pose& pose);

  /// Puts it elsewhere in the world's frame, between two steps. That is no motion: its odometry does not see
  /// it, its speed stays, it is not stalled any more; sensors see it from the next step on. Nothing is asked
  /// of the place: is_free() tells beforehand. Whatever it then overlaps it may leave, but not enter deeper.
  /// What it carries goes with it. Throws std::invalid_argument for a pose that is not finite or outside the
  /// world's bounds, and for what is carried by another; std::logic_error for a part of a model, for a
  /// static body, and within Swarm::for_each(), as all do that change more than one robot. To move many at
  /// once, see Simulation::set_poses.
  void set_pose(const Pose& pose);
  /// Whether it could stand there: within the world's bounds, and free of every wall and every other body.
  bool is_free(const Pose& pose) const;

  /// Its random numbers in this tick, for a program that drives it: a function of the seed, the name (one for
  /// each use), the robot and the tick alone. Asked for twice, they are the same twice.
  Random random(std::string_view name) const;

  /// Names of its sensors, in the order of the world: of a robot those of all its parts, of a part its own.
  std::vector<std::string> sensors() const;
  /// Readings of a ranger, m, one a beam: the whole sensor, counter-clockwise within each transducer.
  /// Empty `sensor`: the first. The span stays valid, and shows new readings after each step.
  /// Throws std::out_of_range with the known names when there is no such sensor, and std::logic_error when it
  /// is not running (subscribe first).
  std::span<const float> ranges(std::string_view sensor = {}) const;
  /// Intensities beside ranges(); empty unless the ranger has `intensity` switched on.
  std::span<const float> intensities(std::string_view sensor = {}) const;
  /// What a sensor, or another device, of it tells, whatever its kind:
  ///
  ///     robot.readings<float>("depth");             // of its camera, m, a value a pixel
  ///     robot.readings<std::int32_t>("id", "eye");  // of the fiducial finder "eye"
  ///
  /// field   by its name; docs/library.md lists those of all kinds, fields() those of one device
  /// device  by its name; empty: the first that has such a field
  /// shape   the field's columns, in its unit. The span stays valid, and shows new readings after each step
  /// errors  std::out_of_range with the known names where there is none of such a name; std::logic_error for
  ///         a sensor that is not running; std::invalid_argument where T is not what the field is made of
  template <class T>
  std::span<const T> readings(std::string_view field, std::string_view device = {}) const {
    const std::span<const std::byte> bytes = cell(field, device, engine::element_of<T>());
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// The same for who learns only at run time what a field is made of: its description, and its bytes.
  struct Reading {
    std::string_view device;                    ///< its name
    const engine::StateField* field = nullptr;  ///< both live as long as the simulation
    std::span<const std::byte> bytes;           ///< of all its columns
  };
  Reading reading(std::string_view field, std::string_view device = {}) const;  ///< errors as of readings()
  /// What readings() can tell of a device: names, elements, columns, units. Throws std::out_of_range with the
  /// known names when there is no such device.
  std::span<const engine::StateField> fields(std::string_view device) const;
  /// What is asked of a device, to be written between two steps; it acts from the next one on. Command is the
  /// struct of its kind (models::GripperCommand, models::LedCommand, ...). Empty `device`: the first that
  /// takes commands of this struct. A controller that uses the device overrides it. Throws std::out_of_range
  /// with the known names where none is called so, and std::invalid_argument where it takes other commands:
  /// of other names (TROUPE_FIELDS), or of another size.
  template <class Command>
  Command& command(std::string_view device = {}) {
    return *reinterpret_cast<Command*>(asked(device, sizeof(Command), Command::troupe_field_names()));
  }
  /// The same for who learns only at run time what it takes.
  struct Asked {
    std::span<const engine::StateField> fields;  ///< with their places among the bytes
    std::span<std::byte> bytes;                  ///< of the struct of the kind
  };
  Asked asked(std::string_view device);  ///< std::out_of_range where no device of this name takes commands

  /// What a power pack holds, and what has gone through it since tick 0, J (docs/energy.md).
  using Energy = engine::Energy;
  /// Of the pack that it runs on: its own, or else the nearest one that it stands on. Nothing where it runs
  /// on none.
  std::optional<Energy> energy() const;
  /// How many flags it holds itself, not what stands on it; 0 where it cannot hold any.
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
  /// One robot's turn in Swarm::for_each(), on its thread.
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

/// What a ray met first.
struct RayHit {
  double range_m = 0;      ///< to its surface; the length of the ray where it met nothing
  BodyId body;             ///< whose it is: Simulation::model(); not valid where it met nothing
  std::uint32_t part = 0;  ///< of the body's type; 0: its root

  bool met() const { return body.valid(); }  ///< anything at all
};

/// A world and its state. Not thread-safe: one thread calls it; it runs on `threads` workers of its own.
/// Several may live in one process.
class Simulation {
 public:
  /// Loads a world file (Stage `.world` or Troupe JSON).
  /// Throws InputError that lists everything wrong with it, each finding as `file:line: error: ...`.
  explicit Simulation(const std::filesystem::path& world, const SimulationOptions& options = {});
  /// The same with kinds of the caller's own: make_registry() (troupe/registry.hpp), and what was added to
  /// it.
  Simulation(const std::filesystem::path& world, const SimulationOptions& options, engine::Registry registry);
  /// Loads a world from its text. `name` stands for the file: its ending, .world or .json, says which syntax
  /// the text has, relative paths in it count from its folder, and findings read `name:line: error: ...`.
  static Simulation from_text(std::string text, const std::filesystem::path& name,
                              const SimulationOptions& options = {});
  /// The same with kinds of the caller's own.
  static Simulation from_text(std::string text, const std::filesystem::path& name,
                              const SimulationOptions& options, engine::Registry registry);
  /// Makes a world that a program describes (troupe/world_builder.hpp). Errors as of from_text(), in the
  /// lines of WorldBuilder::json().
  explicit Simulation(const WorldBuilder& world, const SimulationOptions& options = {});
  /// The same with kinds of the caller's own.
  Simulation(const WorldBuilder& world, const SimulationOptions& options, engine::Registry registry);
  /// Makes a world that a document describes: what a world file in JSON says, as plain data
  /// (worldio/json/world_document.hpp). `name` stands for the file, as of from_text(). Errors as of that, at
  /// the places that the document has.
  explicit Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name = "world.json",
                      const SimulationOptions& options = {});
  /// The same with kinds of the caller's own.
  Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
             const SimulationOptions& options, engine::Registry registry);
  /// Makes a world from a spec (engine/world_spec.hpp): one that a program filled by hand, or that a loader
  /// made. Throws InputError that lists what no world can have, each by the path of the value and, where the
  /// spec has it, its file and line: `types[0].parts[2].size: must be ..., found nan`. Of the options
  /// `robots`, `set` and `search_path` are for files: std::invalid_argument.
  explicit Simulation(engine::WorldSpec world, const SimulationOptions& options = {});
  /// The same with kinds of the caller's own.
  Simulation(engine::WorldSpec world, const SimulationOptions& options, engine::Registry registry);
  /// Goes on from a checkpoint that save() or `troupe run --checkpoint` wrote: the same bits as if the run
  /// had never stopped, on any number of threads, and without the files that its world was loaded from.
  /// Throws InputError, `run.h5: error: ...`, for a file that is no checkpoint, was cut off, is damaged, or
  /// comes from a newer version.
  static Simulation resume(const std::filesystem::path& checkpoint, const ResumeOptions& options = {});
  /// The same with the kinds of the caller's own that the world was loaded with.
  static Simulation resume(const std::filesystem::path& checkpoint, const ResumeOptions& options,
                           engine::Registry registry);
  ~Simulation();
  Simulation(Simulation&&) noexcept;             ///< handles stay valid; the one moved from is of no use
  Simulation& operator=(Simulation&&) noexcept;  ///< as that

  /// What the loader warned of, as `file:line: warning: ...`, of plug-ins as `file: warning: ...`.
  const std::vector<std::string>& warnings() const;
  /// Options as they took effect, `key=value` each, for logs.
  std::vector<std::pair<std::string, std::string>> effective_options() const;

  /// The condition of the world's `stop_when` that holds, as `coverage >= 0.9`: the run is over
  /// (docs/experiments.md). Asked after each step, and of a run that was resumed at once; nothing before the
  /// first step.
  std::optional<std::string> stopped() const;

  /// One tick: sense, decide, move, index. Also where the run is over. Throws engine::StepError, a
  /// std::runtime_error that names tick and robot, where a commanded speed is not a finite number and where a
  /// controller or a device threw; what a callback of on_phase() throws comes out as it is. The
  /// state is then half made: until reset() every function of the simulation, its models, swarms and
  /// observers that reads or continues the state throws std::logic_error.
  void step();
  /// Steps until `seconds` more of world time have passed, or the run is over: see stopped(). A time between
  /// two ticks is rounded up. Throws
  /// std::invalid_argument for what is no time (negative, not a number, beyond 1e12 s).
  void run_for(double seconds);
  /// Steps until `done`, asked after each step, says so. True then; false where `at_most_s` seconds of world
  /// time have passed, or the run is over, before. Throws std::invalid_argument as run_for() does.
  bool run_until(const std::function<bool(const Simulation&)>& done, double at_most_s);
  /// Called with this simulation at the end of every step, also of those that run_for() and run_until() make:
  /// several in the order in which they were added, behind stopped() and what record() writes, which so see
  /// the state as the step left it. What the program does between two steps it may do here (read, command,
  /// set_poses(), spawn(), remove(), save()), but not step(), reset() or on_tick(): std::logic_error. An
  /// exception comes out of step(), with the tick complete; callbacks behind it are not called. Null: all
  /// that were added are forgotten.
  void on_tick(std::function<void(Simulation&)> callback);
  /// Called in every step when what the world's file asks for (`at`, faults) has been done, and before the
  /// tick begins. It may do what programs do between two steps, and act(), but not step() or reset(). An
  /// exception comes out of step(), and leaves the state half made. Null: nothing is called any more.
  void before_tick(std::function<void(Simulation&)> callback);
  /// Does what a person may do to a running world (docs/live.md): between two steps, or in before_tick(),
  /// where it comes after what the world's file asks for. Holds last until they are released, are saved in
  /// checkpoints, and end with reset(). Throws ActRefused (troupe/acts.hpp), and changes nothing, for what
  /// cannot be done.
  void act(const engine::Act& act);
  /// Back to the state after loading, bit for bit: tick 0, the same hashes, then the same run. Handles stay
  /// valid; callbacks and subscriptions stay as they are; speeds that were set do not. Reads no file and
  /// allocates nothing, so that thousands of trials of one world cost what their steps cost; but conditions
  /// with which a run is over restart, which takes memory. A step that threw is forgotten: only this leads
  /// on from it. What record() began is closed.
  void reset();
  /// To the state that the world has after loading with another seed: populations are placed again, and every
  /// draw follows the new seed. The run is that of a simulation loaded with it, bit for bit. All else as
  /// reset(); it allocates. Throws InputError, and changes nothing, where the populations of the world find
  /// no place with this seed; std::logic_error for a run that was resumed from a checkpoint, which does not
  /// know how its bodies were placed.
  void reset(std::uint64_t seed);
  /// Another simulation of the same world with this seed, at tick 0, as if it had been loaded with it. Reads
  /// no file, and shares kinds and plug-ins with this one, which it may outlive. Callbacks and subscriptions
  /// are not copied. threads: as in SimulationOptions. Errors as of reset(seed).
  Simulation another(std::uint64_t seed, unsigned threads) const;

  /// Saves everything that the run goes on from, between two steps, in one HDF5 file that resume() takes: it
  /// needs neither the world's file nor its bitmaps. Written beside the name and renamed when it is whole and
  /// on the disk, so that a checkpoint of this name is the one before or the new one, whenever the process
  /// dies. Callbacks are not saved; subscriptions, and speeds that were set, are. Throws std::runtime_error,
  /// `run.h5: error: ...`, where the file cannot be written or the build has no HDF5; the checkpoint before
  /// is still there then.
  void save(const std::filesystem::path& checkpoint) const;

  /// What looks on may remember earlier ticks: `memory` is called by each save(), and what it gives is kept
  /// in the checkpoint under this name, beside the state. Null: no more.
  void on_save(const std::string& name, std::function<std::vector<std::byte>()> memory);
  /// What was kept under this name in the checkpoint that the run was resumed from; nothing where nothing
  /// was.
  std::optional<std::vector<std::byte>> saved_memory(const std::string& name) const;

  /// The tick of the checkpoint that the run was resumed from, if it was.
  std::optional<std::uint64_t> resumed_at_tick() const;

  double time_s() const;       ///< on the world's clock
  std::uint64_t tick() const;  ///< how many there have been
  double tick_s() const;       ///< length of a tick
  /// That are in the world.
  std::size_t robots() const;
  std::uint64_t seed() const;  ///< of all random draws
  std::string title() const;   ///< the world's, else its file's name
  /// Where the world itself asks to end.
  std::optional<double> quit_time_s() const;

  /// The model of this name: a body, or a part below it ("r0.ranger:1"), under the name that the world gives
  /// or the one that Stage would generate. Throws std::out_of_range with near names when there is none.
  Model find(std::string_view name);
  /// The model with this id, as sensors and cast() tell it. Throws std::out_of_range when there is none.
  Model model(BodyId id);
  /// The first surface along a ray, by exact geometry, in worlds that ask for the grid engine, too.
  /// from       where it starts, m, and where it goes, rad: world frame; it stays at the height from.z
  /// range_max  m; what is as far or farther is not met
  /// without    a model that it passes, with all that this carries: who looks from within a robot
  /// meets      what rangers meet (ranger_return >= 0), where the closed z interval holds the height, from
  ///            both sides; computed in doubles, so that it may differ from a reading in the last bits of a
  ///            float
  /// ties       two surfaces at one distance: the lower (id, part)
  /// errors     std::invalid_argument for what is not finite, and a range below 0 or beyond 300 km
  /// cost       a walk along the ray. Changes nothing: several threads may cast at once, between two steps
  RayHit cast(const Pose& from, double range_max, const Model* without = nullptr) const;
  /// Many robots at once (troupe/swarm.hpp), in the order of their ids: those of the type or the population
  /// of this name, or the one robot; of an empty text all. Throws std::out_of_range with the known names
  /// where no robot is called so.
  Swarm swarm(std::string_view of = {});
  /// Model::set_pose of many, at little more than the cost of one: bodies are indexed once. Where one of them
  /// cannot be put none is.
  void set_poses(std::span<const std::pair<Model, Pose>> poses);
  /// Bears the next body of a population's reserve, between two steps, at a pose in the world's frame, m and
  /// rad, where it touches nothing solid: sensors see it from the next step on, in which its life begins as
  /// that of others at tick 0. Nothing where that place is taken or outside of the world, or no body of the
  /// reserve is left. Throws std::out_of_range for a population without a reserve, and std::invalid_argument
  /// for a pose that is not finite. Costs the indexing of all bodies.
  std::optional<Model> spawn(std::string_view population, const Pose& pose);
  /// How many of a population's reserve are still to be born.
  std::size_t unborn(std::string_view population) const;
  /// Ends a life, between two steps: the body is no longer met or seen, what it carried lies where it
  /// was, and its id is never used again. Does nothing to a body that is not there. Throws std::logic_error
  /// for a part of a model, for a static body, and in a world in which no body is born or dies: a world with
  /// a reserve, or with `"mortal": true`, is another. Costs the indexing of all bodies.
  void remove(const Model& model);
  /// Stops all of a body, between two steps: controllers, drive, sensors, which keep their readings, and
  /// other devices. It stands where it is, and is met and seen. False where it is disabled already, or not in
  /// the world. Throws std::logic_error for a part of a model, for a static body, and in a world in which
  /// nothing is ever disabled: one with faults, with `disable` in its `at`, or with `"mortal": true`, is
  /// another.
  bool disable(const Model& model);
  /// What disable() stopped goes on with what it was told last. False where it is not disabled. Throws as
  /// that.
  bool enable(const Model& model);
  /// Names of all robots that are in the world, in id order.
  std::vector<std::string> robot_names() const;
  /// Runs every sensor of a robot, as Stage's Subscribe does; before the first step.
  void subscribe(std::string_view model);

  /// Records this run from now on (troupe/recording.hpp): the state as it is now, and then of each step whose
  /// tick is due, until stop_recording(), reset() or its own end. Throws as Recording does, and
  /// std::logic_error where it records already.
  void record(const std::filesystem::path& file);
  void record(const std::filesystem::path& file, const RecordingOptions& options);  ///< as that
  /// Closes it; plain tools read the file from now on. Throws std::runtime_error where that fails; does
  /// nothing where nothing is recorded.
  void stop_recording();

  /// Hash of the whole state, docs/determinism.md.
  std::uint64_t state_hash() const;
  /// The same by group: pose, velocity, sensor, memory.
  struct Hashes {
    std::uint64_t state = 0;     ///< the sum of the others, modulo 2^64
    std::uint64_t pose = 0;      ///< poses, who carries whom, who lives
    std::uint64_t velocity = 0;  ///< velocities, what is asked of drives and devices, stalls
    std::uint64_t sensor = 0;    ///< readings, and the state of other devices
    std::uint64_t memory = 0;    ///< of controllers; odometry; what keeps bodies from working
  };
  Hashes hashes() const;  ///< of the state that it is in
  /// First lines of a hash log: `# key: value` each, free to differ between runs that agree.
  std::string hash_log_header() const;
  /// One line of a hash log: `tick state pose=... velocity=... sensor=... memory=...`.
  std::string hash_log_line() const;

  Statistics statistics() const;  ///< until now; costs a look at each robot
  /// The sums over all power packs of the world, in the order of ids; `infinite` and `charging` where any is.
  Model::Energy energy() const;
  unsigned threads() const;  ///< of the parallel loop
  /// Called as each phase begins, and once more with no phase as the tick ends; for timing.
  void on_phase(std::function<void(std::optional<Phase>)> callback);
  /// Called on its worker as a task of a parallel loop begins (true) and ends (false), with the task's index
  /// in its loop; on several workers at once, so it must be thread-safe. For profiles; set between steps.
  void on_task(std::function<void(std::size_t task, bool begins)> callback);
  /// Called on the thread that steps as each parallel loop begins (true) and ends (false), also of loops that
  /// run between steps (hashes, measures); for timing. Set between steps.
  void on_loop(std::function<void(bool begins)> callback);

  /// The engine's view of it (engine/world.hpp): types, state tables and hooks, for tools that compare or
  /// save a state without knowing it. Lives as long as the simulation does.
  engine::World& world();
  const engine::World& world() const;  ///< the same
  /// The kinds it was made of. Lives as long as the simulation does.
  const engine::Registry& registry() const;

  /// Draws the world from above into a PNG. Throws std::runtime_error where OSMesa is missing, the build has
  /// no render, or the file cannot be written.
  void snapshot(const std::filesystem::path& png, int width = 1280, int height = 720) const;
  /// The same as the options say (troupe/pictures.hpp): from where, of what size, with which layers. Throws
  /// also InputError for what the world has not.
  void snapshot(const std::filesystem::path& png, const PictureOptions& options) const;
  /// The same picture in memory: 8-bit RGB, three bytes a pixel, row 0 on top. Throws also
  /// std::invalid_argument for a size below 1. What pictures of one scene have in common is made with the
  /// first and kept for the next of the same options, so these calls must not be made on two threads at once.
  std::vector<std::uint8_t> picture(int width = 1280, int height = 720) const;
  std::vector<std::uint8_t> picture(const PictureOptions& options) const;  ///< the same

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
