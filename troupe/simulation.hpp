#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/act.hpp"
#include "engine/kinds/energy.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/ranks/rank_work.hpp"
#include "engine/sensing/ray_hit.hpp"
#include "engine/spec/ranging_engine.hpp"
#include "engine/state/phase.hpp"

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
class RankProcesses;
class SourceFiles;
struct Script;
}  // namespace troupe
namespace troupe::engine {
class World;
struct Contact;  // engine/kinds/components.hpp
struct BodySpec;
struct Registry;
struct WorldSpec;
enum class ControlMode : std::uint8_t;
// Defined in engine/kinds/controller.hpp, which the header of each command struct includes.
template <class Memory>
std::vector<StateField> memory_fields();  // NOLINT(readability-redundant-declaration)
}  // namespace troupe::engine
namespace troupe::worldio {
struct LoadOptions;
struct WorldDocument;
}  // namespace troupe::worldio

namespace troupe {

/// How rangers (range sensors such as laser scanners) compute ranges: by exact ray-surface intersection, or
/// by stepping through an occupancy grid (docs/sensing.md).
using engine::RangingEngine;
/// The result of Simulation::cast(): the first surface that a ray meets.
using engine::RayHit;
/// Thrown by a step that cannot be completed; a std::runtime_error (engine/kinds/step_error.hpp).
using engine::StepError;

/// The largest number of ranks, the threads or processes that compute one world together
/// (SimulationOptions::ranks).
inline constexpr unsigned k_most_ranks = 1024;  // = partition::k_most_ranks

/// How a world is loaded and run. The class Simulation explains the terms that this file uses. The options
/// `seed`, `ranging`, `robots`, `set`, `scripts` and `spare` can change the simulated results. `search_path`
/// and `plugin_path` determine which files are found. `mortal` allows calls of Simulation::remove(),
/// disable() and enable(). All other options change no result.
struct SimulationOptions {
  /// Number of worker threads, at most 1,024; a larger number throws std::invalid_argument. 0: one thread per
  /// processor that the affinity mask and the control groups of the process allow.
  unsigned threads = 0;
  /// Edge length of the square tiles into which the world is divided for parallel work, m. 0, a negative
  /// number or NaN: Troupe chooses it from body sizes and sensor ranges.
  double tile_size_m = 0;
  /// Seed of all random numbers of the run. Not set: the seed of the world file.
  std::optional<std::uint64_t> seed = {};
  /// How rangers compute ranges. Not set: as the world file states.
  std::optional<RangingEngine> ranging = {};
  /// New sizes of populations (groups of bodies of one type that a world file creates with one entry): pairs
  /// of the name of a population and its new number of robots. An empty name means the only population of the
  /// world. Loading the world throws InputError for an unknown name, and for an empty name if the world does
  /// not have exactly one population.
  std::vector<std::pair<std::string, std::size_t>> robots = {};
  /// Values of the world file to replace: pairs of a JSON pointer (a path in the file, RFC 6901) and a JSON
  /// value, such as {"/populations/0/count", "500"}. A pointer that ends in `/-` appends the value to a list.
  /// For a `.world` file, the pointers refer to the JSON world that Troupe makes of it. Loading the world
  /// throws InputError if `seed`, `ranging` or `robots` gives a value that is also in this list.
  std::vector<std::pair<std::string, std::string>> set = {};
  /// Directories in which Troupe searches for a world file that does not exist at the given path. It searches
  /// them in their order, for a file of the same name. In the same way it searches for files that a `.world`
  /// file includes, but not for files that a JSON world includes.
  std::vector<std::filesystem::path> search_path = {};
  /// Directories to search for plug-ins: shared libraries with controllers, measures, sensors or other
  /// devices that Troupe does not ship (docs/controllers.md).
  std::vector<std::filesystem::path> plugin_path = {};
  /// Scripts, such as Python files, with controllers and measures (troupe/script.hpp); none may be null. The
  /// controllers replace those that the world file gives to the same robots.
  std::vector<std::shared_ptr<const Script>> scripts = {};
  /// Allows the program to call Simulation::remove(), disable() and enable(), as `"mortal": true` in the
  /// world file does. The option itself changes no state hash; only the bodies that the program removes or
  /// disables do.
  bool mortal = false;
  /// Lets the state say what blocks bodies, as `"contacts": true` in the world file does, for
  /// Model::blocked_by() and Swarm::blocked_by(). Each blocked body then changes the state hash.
  bool contacts = false;
  /// Number of robots that spawn() can add to each population while the world runs (docs/lives.md). Loading
  /// the world adds them to the population as its reserve, with ids after those of all other bodies.
  /// Populations for which the world file declares a reserve get no further robots. A world with a reserve
  /// has other state hashes (64-bit hashes of the whole state) than the same world without a reserve. Loading
  /// the world throws std::invalid_argument for more than k_most_spare robots.
  std::uint32_t spare = 0;
  static constexpr std::uint32_t k_most_spare = 1'000'000;  ///< greatest value of `spare`
  /// Number of ranks among which the robots are divided, from 1 to 1,024 (docs/cluster.md). Each rank is a
  /// thread of this process that has its own copy of the world (its replica) and its own worker threads. With
  /// more than one rank, `threads` is the number of worker threads per rank; 0: the number of available
  /// processors, divided by the number of ranks.
  ///
  /// Loading the world throws std::invalid_argument for other numbers of ranks. It also throws for more than
  /// one rank if a launcher such as mpirun started several processes of this program.
  unsigned ranks = 1;
  /// For tests of the ranks. If a seed is given, messages between ranks arrive late and in random order, and
  /// robots move to random ranks during the run. The seed determines these random choices. No simulated
  /// result depends on it.
  std::optional<std::uint64_t> rank_seed = {};
  /// A clock with which the ranks of this process measure how long the work for their own robots takes. The
  /// function returns the present time, s, from any fixed origin. It is called on the threads of all ranks,
  /// with the number of the calling rank as its argument. With a clock, robots move to other ranks if the
  /// ranks take unequal times, and rank_work() and rank_statistics() contain times. No result depends on the
  /// clock. Null: no clock.
  std::function<double(unsigned rank)> rank_clock = {};
  /// The processes that compute the world together. This process is rank 0. Only the program `troupe` sets
  /// this option (docs/cluster.md). Null: this process computes the world alone.
  std::shared_ptr<RankProcesses> processes = {};
  /// True: each rank stores only the state of its own robots and of robots near them (docs/cluster.md). This
  /// process then has the state of all other robots only after a call of engine::World::gather(), which
  /// fetches the state from the other ranks. Only the program `troupe` sets this option.
  ///
  /// The option has no effect if only one rank computes the world, or if the world cannot be distributed in
  /// this way. In the second case RankStatistics::why_replicated states the reason.
  bool distribute = false;
};

/// How a run is resumed from a checkpoint, a file with the whole state of a run that Simulation::save()
/// wrote. Only the options `set`, `across_versions` and `across_plugins` can change the simulated results.
struct ResumeOptions {
  /// Number of worker threads, as in SimulationOptions.
  unsigned threads = 0;
  double tile_size_m = 0;  ///< edge length of the tiles, m, as in SimulationOptions
  /// Values of the world to replace: pairs of a JSON pointer (RFC 6901) and a new JSON value, such as
  /// {"/types/1/drive/params/velocity_max_x_mps", "0.5"}. The pointers refer to the JSON text in the dataset
  /// /world of the checkpoint, which is an HDF5 file. Only values that do not change the layout of the state
  /// can be replaced; docs/checkpoints.md lists them. The resumed run then differs from the original.
  std::vector<std::pair<std::string, std::string>> set = {};
  /// Accepts a checkpoint that another version of Troupe wrote. The results may then differ, in their last
  /// bits or more, from those of that version.
  bool across_versions = false;
  /// Directories to search for plug-ins, as in SimulationOptions. They must contain every plug-in that the
  /// run used.
  std::vector<std::filesystem::path> plugin_path = {};
  /// Scripts, as in SimulationOptions. They must contain every script that the run used.
  std::vector<std::shared_ptr<const Script>> scripts = {};
  /// Accepts plug-ins and scripts whose files differ from those that were loaded when the checkpoint was
  /// written.
  bool across_plugins = false;
  unsigned ranks = 1;  ///< number of ranks, as in SimulationOptions; may differ from the saved run
  std::optional<std::uint64_t> rank_seed = {};           ///< for tests, as in SimulationOptions
  std::function<double(unsigned rank)> rank_clock = {};  ///< as in SimulationOptions
  std::shared_ptr<RankProcesses> processes = {};         ///< as in SimulationOptions
  bool distribute = false;                               ///< as in SimulationOptions
};

/// The phases of a tick (a time step), in the order in which they run: intervene, sense, actuate, decide,
/// move and index (engine/state/phase.hpp). k_phases is their number; phase_name() returns the name of a
/// phase.
using engine::k_phases;
using engine::Phase;
using engine::phase_name;

/// Numbers that describe a run: counters since tick 0, and the state after the last tick. A robot is a body
/// whose type has a drive.
struct Statistics {
  std::size_t robots = 0;          ///< number of robots that are in the world now
  std::uint64_t ticks = 0;         ///< completed ticks (time steps)
  double time_s = 0;               ///< simulated time, s
  std::uint64_t beams = 0;         ///< rays that sensors have cast
  std::size_t stalled = 0;         ///< robots whose last motion was blocked or would have left the bounds
  std::size_t held_at_bounds = 0;  ///< robots whose last motion would have left the bounds of the world
  /// Mean straight-line distance of the robots from their positions at tick 0 or at birth, m.
  double mean_displacement_m = 0;
  /// Number of rounds in which Troupe decided which motions happen, summed over all ticks. Two motions
  /// conflict if the bodies would overlap at their new poses; then they cannot both happen. A tick has one
  /// round, and more if the motion of a body must wait for the decision about a conflicting motion.
  std::uint64_t conflict_rounds = 0;
  std::size_t state_bytes = 0;  ///< memory of all state tables, which hold the state of the bodies, bytes
};

/// What rank 0 has sent to the other ranks so far, and how long it has waited for them. The ranks are the
/// threads or processes that compute one world together (SimulationOptions::ranks). With one rank, all
/// numbers except `ranks` and `nodes` are 0.
struct RankStatistics {
  unsigned ranks = 1;          ///< number of ranks
  unsigned nodes = 1;          ///< number of computers on which the ranks run
  std::uint64_t messages = 0;  ///< number of messages that rank 0 has sent to other ranks
  std::uint64_t bytes = 0;     ///< total length of these messages, bytes
  /// Time that rank 0 has waited, s; 0 if SimulationOptions::rank_clock and SimulationOptions::processes are
  /// both null.
  double waited_s = 0;
  /// Number of times that robots were moved to other ranks because the slowest rank took more than 1.1 times
  /// the mean time of all ranks.
  std::uint64_t rebalanced = 0;
  /// Number of signals SIGUSR1, which request a checkpoint, that the processes of other ranks have received.
  std::uint64_t requests = 0;
  /// Whether such a process has received a signal that requests the end of the run.
  bool is_stop_requested = false;
  /// Whether the world is distributed: each rank has only the state of its own robots and of robots near
  /// them. Otherwise, each rank has the state of all robots.
  bool is_distributed = false;
  /// Why the world is not distributed although SimulationOptions::distribute is true; else empty.
  std::string why_replicated;
  /// If the world is distributed: how often its robots were divided among the ranks again during the run.
  std::uint64_t distributions = 0;
};

/// Number of bodies that a rank computed in the last tick, and the times of its phases sense, actuate and
/// decide, s (engine/ranks/rank_work.hpp).
using engine::RankWork;
/// What a rank has counted so far: for example, how many bodies it has computed, and how many messages it has
/// sent (engine/ranks/rank_work.hpp).
using engine::RankCounts;

class Recording;
class Simulation;
class Swarm;
class WorldBuilder;
struct PictureOptions;
struct RecordingOptions;

/// A handle of one model of a simulation: a body, or a part that is mounted on a body, such as a sensor. A
/// copy of the handle is cheap and refers to the same model. The handle is valid while the simulation lives,
/// also after Simulation::reset(). Call its functions between two steps: during a step, for example in a
/// controller, those that change the simulation throw std::logic_error. speed(), stalled(), estimate() and
/// set_estimate() throw std::logic_error for static geometry: a body without drive, device and controller
/// that cannot be gripped or pushed.
class Model {
 public:
  /// The name of the model. For a handle from Simulation::find(), it is the name given to find(), which may
  /// be an alias. For other handles, it is the name in the world file. If the file gives the model no name,
  /// it is the name that the simulator Stage would generate, such as "position:0".
  const std::string& name() const;
  /// Id of the body; for a part, the id of the body that it is mounted on. Simulation::cast() and sensors
  /// that identify bodies (fiducial finders, bumpers, radios) report this id, and Simulation::model() takes
  /// it.
  BodyId id() const;
  /// Whether two handles refer to the same body, or to the same part of a body, of one simulation. Their
  /// names may differ, because a name may be an alias.
  bool operator==(const Model& other) const;
  /// Pose in the world frame, m and rad. The pose of a part on a joint includes the motion of the joint. A
  /// body that was removed keeps its last pose; the pose of a body that is not yet born is NaN.
  Pose pose() const;
  /// Size of the body or part along its x, y and z axes as declared in the world file, m.
  Eigen::Vector3d size() const;
  /// Commands speeds in the body frame: forward and left in m/s, turn in rad/s (for a car drive: the steering
  /// angle, rad). They apply from the next tick on, within the limits of the drive, until another command
  /// replaces them. If the robot has a controller, its next decision replaces them. The command also switches
  /// on all devices that the controller has switched off, until the controller decides again.
  ///
  /// The command goes to the drive of the body. For a part that has a drive of its own (a device `wheels`),
  /// it goes to that drive. accelerate() and go_to() use the same drive and throw the same exceptions as
  /// set_speed().
  ///
  /// Throws std::logic_error for a model that has no drive, and for a body that is not in the world, and
  /// std::invalid_argument if a number is not finite.
  void set_speed(double forward, double left, double turn);
  /// Commands speeds as the other set_speed() does, with left = 0.
  void set_speed(double forward, double turn) { set_speed(forward, 0, turn); }
  /// Commands accelerations in the body frame: forward and left in m/s^2, turn in rad/s^2 (for a car drive:
  /// the steering angle, rad). They apply from the next tick on, within the drive's limits of acceleration
  /// and speed, until another command replaces them. Throws as set_speed() does.
  void accelerate(double forward, double left, double turn);
  /// Commands accelerations as the other accelerate() does, with left = 0.
  void accelerate(double forward, double turn) { accelerate(forward, 0, turn); }
  /// Commands a goal pose, m and rad, in the frame of the robot's estimated pose (estimate()). The robot
  /// drives to the goal and stays there until another command replaces this one. docs/driving.md describes
  /// the path that each kind of drive takes. Throws as set_speed() does.
  void go_to(double x, double y, double heading);
  /// Commands a goal pose as the other go_to() does; ignores goal.z.
  void go_to(const Pose& goal) { go_to(goal.x, goal.y, goal.heading); }
  /// A velocity in the body frame.
  struct Speed {
    double forward = 0;  ///< speed forward, m/s
    double left = 0;     ///< speed to the left, m/s
    double turn = 0;     ///< turn rate, counter-clockwise, rad/s
  };
  /// Velocity that the drive of this model computed in the last tick, in the body frame. This velocity does
  /// not change if an obstacle blocks the motion; stalled() is then true. At tick 0 it is the initial
  /// velocity of the drive (0 for a part with a device `wheels`). It is 0 for a model without a drive, for a
  /// body that is not in the world, and while a body is disabled or its drive has no power.
  Speed speed() const;
  /// Whether the body is in the world: it was spawned or present from the start, and it was not removed
  /// (docs/lives.md). Static geometry is always in the world.
  bool is_alive() const;
  /// Whether the robot's motion in the last tick was blocked by an obstacle or would have ended outside the
  /// bounds of the world; false before the first step.
  bool stalled() const;
  /// What blocked the robot, or one of its joints, in the last tick; all members are zero if nothing did.
  /// Throws std::logic_error if the state of the world does not say so: see SimulationOptions::contacts.
  engine::Contact blocked_by() const;
  /// Estimated pose of the body, m and rad. The drive parameter `localization` of the world file selects the
  /// estimate of a robot:
  /// - `gps`: the true pose, by default in the world frame
  /// - `odom`: an estimate from wheel odometry, by default in the frame of the robot's pose at tick 0 or at
  ///   its birth
  ///
  /// If the drive parameter `localization_origin` is given, it defines the frame of the estimate instead. For
  /// a body without a drive, the result is the true pose in the world frame. For a part with a device
  /// `wheels`, it is the true pose of the part, pose(). For any other part, it is the estimate of the body.
  /// The numbers are 0 for a body that is not yet born, and for a removed body with `odom`.
  Pose estimate() const;
  /// Overwrites the odometry estimate: m and rad, in the frame of estimate(); pose.z is ignored. Throws
  /// std::logic_error if the localization of the robot is not `odom` or if the robot is not in the world, and
  /// std::invalid_argument if a number is not finite.
  void set_estimate(const Pose& pose);

  /// Places the body at a pose in the world frame, m and rad, between two steps. Bodies that it carries move
  /// with it. Sensors see the new pose from the next step on. Odometry does not measure the change of pose,
  /// the speed does not change, and stalled() becomes false.
  ///
  /// At the new pose the body may overlap other bodies; is_free() tells whether it would. The body can then
  /// drive out of an overlap, but not deeper into it. Simulation::set_poses() moves many models faster.
  ///
  /// Throws std::invalid_argument
  /// - if the pose is not finite or is outside the bounds of the world,
  /// - if the body is carried by another body, or
  /// - if the body is not in the world.
  ///
  /// Throws std::logic_error for a part of a body, for static geometry, and in the function that
  /// Swarm::for_each() calls.
  void set_pose(const Pose& pose);
  /// Whether the body could be placed at this pose in the world frame, m and rad: its origin would be inside
  /// the bounds of the world, and it would not overlap a wall or another body that is an obstacle. False if
  /// the pose is not finite. Throws std::logic_error for a part of a body and for static geometry.
  bool is_free(const Pose& pose) const;

  /// Returns a random number stream for a program that drives this robot. The stream depends only on the seed
  /// of the simulation, `name`, the robot and the current tick. A second call with the same name in the same
  /// tick therefore returns the same numbers: use one name per purpose.
  Random random(std::string_view name) const;

  /// Names of the sensors, in the order of the world file. If this model is a body, these are the sensors on
  /// all its parts; if it is a part, only the sensors on this part.
  std::vector<std::string> sensors() const;
  /// Ranges that a ranger measured, m, one per beam, counter-clockwise within each transducer (a fan of beams
  /// that start at one pose). All ranges are 0 before the first step and for a body that is not in the world.
  /// sensor: name of the ranger; empty: the first ranger. The span stays valid while the simulation lives,
  /// and its content changes with each step.
  ///
  /// Throws std::out_of_range, with the known names, if there is no such ranger. Throws std::logic_error if
  /// the ranger does not run; Simulation::subscribe() makes all sensors of a robot run.
  std::span<const float> ranges(std::string_view sensor = {}) const;
  /// Intensities that the ranger named `sensor` measured, one per value of ranges(); errors as in ranges().
  /// The span is empty unless the parameter `intensity` of the ranger is true.
  std::span<const float> intensities(std::string_view sensor = {}) const;
  /// Returns the values of one named field of a device: of the readings of a sensor, or of the state of
  /// another device such as a gripper or a power pack:
  ///
  ///     robot.readings<float>("depth");             // depth image of its camera, m, one value per pixel
  ///     robot.readings<std::int32_t>("id", "eye");  // ids seen by the fiducial finder "eye"
  ///
  /// field   name of the field; docs/library.md lists the fields of all kinds of devices, and fields() lists
  ///         those of one device
  /// device  name of the device, or component of the state with the memory of a controller, such as
  ///         `wander/0`; empty: the first device that has this field
  /// result  all values of the field, in the unit of the field. The span stays valid while the simulation
  ///         lives, and its content changes with each step
  /// errors  std::out_of_range, with the known names, for an unknown field or device; std::logic_error for a
  ///         sensor that does not run; std::invalid_argument if T is not the element type of the field
  template <class T>
  std::span<const T> readings(std::string_view field, std::string_view device = {}) const {
    const std::span<const std::byte> bytes = cell(field, device, engine::element_of<T>());
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// The values of one field of a device as bytes, for callers that know the type of these values only at run
  /// time.
  struct Reading {
    /// Name of the device, or component of the state with the memory; lives as long as the simulation.
    std::string_view device;
    const engine::StateField* field = nullptr;  ///< description of the field; lives as long as the simulation
    std::span<const std::byte> bytes;           ///< all values of the field
  };
  /// Returns one field of a device as bytes. The parameters are those of readings(). Throws std::out_of_range
  /// and std::logic_error as readings() does.
  Reading reading(std::string_view field, std::string_view device = {}) const;
  /// The fields of a device, or of the memory of a controller, that readings() can return, with their names,
  /// element types, numbers of values and units. Throws std::out_of_range, with the known names, if there is
  /// no such device.
  std::span<const engine::StateField> fields(std::string_view device) const;
  /// Returns a reference to the command of a device. A program may write the command between two steps; it
  /// applies from the next step on. If a controller of the robot uses the device, its next decision replaces
  /// the command. The reference is valid while the simulation lives, also after reset(). If the body is not
  /// yet born after a reset(), writing has no effect: a body is born with commands of 0.
  ///
  /// Command  the command struct of the kind of device: models::GripperCommand, models::LedCommand, ...
  /// device   name of the device; empty: the first device that takes this struct
  /// errors   std::out_of_range, with the known names, if there is no such device; std::invalid_argument if
  ///          the device takes a struct with other fields (names, types, offsets) or another size;
  ///          std::logic_error for a body that is not in the world
  template <class Command>
  Command& command(std::string_view device = {}) {
    static const std::vector<engine::StateField> fields = engine::memory_fields<Command>();
    return *reinterpret_cast<Command*>(asked(device, sizeof(Command), fields));
  }
  /// The command of a device as bytes, for callers that know its fields only at run time.
  struct Asked {
    std::span<const engine::StateField> fields;  ///< fields of the command, with their offsets in `bytes`
    std::span<std::byte> bytes;                  ///< the command, in the layout of its command struct
  };
  /// Returns the command of the device of this name as bytes. A program may read and write the bytes like the
  /// reference that command() returns; a bool (StateField::is_bool) must be 0 or 1. Throws std::out_of_range
  /// if this model has no device of this name that takes commands, and std::logic_error for a body that is
  /// not in the world.
  Asked asked(std::string_view device);
  /// Returns descriptions of the fields of the command that the device of this name takes, also for a body
  /// that is not in the world. Throws std::out_of_range if this model has no device of this name that takes
  /// commands.
  std::span<const engine::StateField> command_fields(std::string_view device) const;

  /// State of a power pack (the energy store of a body): its charge, and the energy that it dissipated,
  /// received and gave since the body came into the world, J (docs/energy.md).
  using Energy = engine::Energy;
  /// Energy of the power pack that supplies this model. The search for the pack begins with this part,
  /// continues with the part on which it is mounted, and so on, and ends with the body itself. The first pack
  /// that is found supplies the model. Empty if none is found.
  std::optional<Energy> energy() const;
  /// Number of flags (coloured tokens that bodies exchange, docs/energy.md) that the first device of the kind
  /// `flags` on this part holds; 0 if the part has no such device. Devices on other parts of the body do not
  /// count, even if this model is the whole body.
  std::size_t flag_count() const;

 private:
  friend class Simulation;
  friend class Swarm;
  struct Place;
  explicit Model(std::shared_ptr<const Place> place);
  static Model of(engine::World& world, BodyId body);
  std::span<const std::byte> cell(std::string_view field, std::string_view device,
                                  engine::Element element) const;
  std::byte* asked(std::string_view device, std::size_t bytes, std::span<const engine::StateField> fields);
  /// The call of a function by Swarm::for_each() for one robot. for_each() keeps an object of this class on
  /// the calling thread during the call. While the object exists, functions on this thread throw
  /// std::logic_error if they would change anything but the commands and the estimate of this robot.
  class Visit {
   public:
    explicit Visit(const Model& robot);
    ~Visit();
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    const Model* before_;  // robot that was marked on this thread before; null if none
  };
  /// Throws std::logic_error during a step, and in a function that Swarm::for_each() calls. what: name of the
  /// calling function, for the error.
  static void require_may_change(const engine::World& world, std::string_view what);
  static void require_finite(std::string_view robot, double x, double y, double turn);
  /// As require_may_change(), but allows a function that Swarm::for_each() calls to command its own robot.
  void require_may_command(std::string_view call) const;
  void refuse_absent() const;
  void command(engine::ControlMode mode, double x, double y, double turn);
  std::shared_ptr<const Place> place_;
};

/// A world and its state. Not thread-safe: use each simulation from one thread at a time, except that several
/// threads may call cast() at once. A simulation computes on worker threads of its own
/// (SimulationOptions::threads). A process may have several simulations.
///
/// These terms are used in this file; docs/glossary.md defines them and others:
///
/// body          a robot, another object, or static geometry such as walls; every body has an id
/// type          the properties that bodies of the same construction share: shape, drive, devices,
///               controllers
/// drive         the equipment that moves a body; a robot is a body whose type has a drive
/// device        equipment of a body that has state, such as a gripper; a sensor is a device that only
///               observes
/// controller    code that computes the commands of a robot, for example from its sensor readings
/// kind          an implementation of a drive, device, controller, measure or fault, such as the sensor
///               `ranger`; a registry lists the kinds that a world can use
/// population    an entry of the world file that creates many bodies of one type, placed by a rule. Its
///               reserve consists of bodies that are not in the world at tick 0 and can be born later
/// tick          a time step of constant length, tick_s(); tick 0 is the state after loading
/// intervention  a change of the world at a given time, which the world file lists under the key `at`
/// fault         a failure of a robot, such as a dead sensor, which the world file describes
/// measure       a number that is computed from the state, such as the covered area
class Simulation {
 public:
  /// Loads a world file (Stage `.world` or Troupe JSON). Throws InputError, whose text lists all errors in
  /// the file, each as `file:line: error: ...`, and std::invalid_argument for numbers of threads or ranks
  /// that are not allowed.
  explicit Simulation(const std::filesystem::path& world, const SimulationOptions& options = {});
  /// Loads a world file that uses kinds of sensors, other devices, drives or controllers that the program
  /// defines. To make `registry`, take the result of make_registry() (troupe/registry.hpp), which has the
  /// kinds that Troupe ships, and add the kinds of the program. Throws std::invalid_argument if a kind or a
  /// preset of the registry is wrong, for example if two kinds of one sort have the same name.
  Simulation(const std::filesystem::path& world, const SimulationOptions& options, engine::Registry registry);
  /// Loads a world from the text of a world file. `name` is used like the path of this file, which need not
  /// exist: the ending of `name`, .world or .json, selects the syntax, relative paths in the text are
  /// resolved from the folder of `name`, and errors read `name:line: error: ...`. Throws as the constructor
  /// that loads a file does.
  static Simulation from_text(std::string text, const std::filesystem::path& name,
                              const SimulationOptions& options = {});
  /// Loads a world from its text, with the kinds in `registry`.
  static Simulation from_text(std::string text, const std::filesystem::path& name,
                              const SimulationOptions& options, engine::Registry registry);
  /// Makes the world that a WorldBuilder describes (troupe/world_builder.hpp). Throws InputError as
  /// from_text() does; its line numbers are those of the text that WorldBuilder::json() returns.
  explicit Simulation(const WorldBuilder& world, const SimulationOptions& options = {});
  /// Makes the world that a WorldBuilder describes, with the kinds in `registry`.
  Simulation(const WorldBuilder& world, const SimulationOptions& options, engine::Registry registry);
  /// Makes a world from a document: the content of a JSON world file as plain C++ data
  /// (worldio/json/world_document.hpp). `name` is used in place of a file name, as in from_text(). Throws
  /// InputError as from_text() does, but with the file and line that the document stores for the wrong value.
  explicit Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name = "world.json",
                      const SimulationOptions& options = {});
  /// Makes a world from a document, with the kinds in `registry`.
  Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
             const SimulationOptions& options, engine::Registry registry);
  /// Makes a world from a spec, the description that the engine uses internally (engine/spec/world_spec.hpp).
  /// A program can make a spec itself, or get it from a function that reads a world file. Throws InputError,
  /// whose text lists all invalid values: `types[0].parts[2].size: must be ..., found nan`. File and line
  /// come first if the spec has them. Throws std::invalid_argument if the option `robots`, `set` or
  /// `search_path` is given, because these apply to world files only.
  explicit Simulation(engine::WorldSpec world, const SimulationOptions& options = {});
  /// Makes a world from a spec, with the kinds in `registry`.
  Simulation(engine::WorldSpec world, const SimulationOptions& options, engine::Registry registry);
  /// Resumes a run from a checkpoint that save() or `troupe run --checkpoint` wrote. All further results are
  /// the same, bit for bit, as if the run had never stopped, on any number of threads. The files that the
  /// world was loaded from are not needed, except plug-ins and scripts.
  ///
  /// Throws InputError, `run.h5: error: ...`, in these cases:
  /// - The file is not a checkpoint, is truncated or is damaged.
  /// - Another version of Troupe wrote the file, and ResumeOptions::across_versions is false.
  /// - A plug-in or script of the run is missing.
  /// - A plug-in or script of the run has changed, and ResumeOptions::across_plugins is false.
  /// - A value of ResumeOptions::set is invalid.
  ///
  /// Throws std::invalid_argument for numbers of threads or ranks that are not allowed.
  static Simulation resume(const std::filesystem::path& checkpoint, const ResumeOptions& options = {});
  /// Resumes a run whose world was loaded with a registry that the program made. `registry` must have the
  /// same kinds as that registry.
  static Simulation resume(const std::filesystem::path& checkpoint, const ResumeOptions& options,
                           engine::Registry registry);
  ~Simulation();
  /// Moving: models and swarms of the moved simulation stay valid. The moved-from object may only be
  /// destroyed or assigned to.
  ///@{
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ///@}
  /// Returns another object for the same simulation, which exists until both objects are destroyed. This is
  /// for objects that use a simulation for longer than a call, such as live::View, because a reference would
  /// not follow a move.
  Simulation share();

  /// Warnings that loading the world or the checkpoint has produced. Warnings about the world file have the
  /// form `file:line: warning: ...`. Warnings about plug-ins and the checkpoint have the form
  /// `file: warning: ...`.
  const std::vector<std::string>& warnings() const;
  /// The options that the simulation uses (world, seed, number of threads, ...), as pairs of key and value,
  /// for logs. All keys differ.
  ///
  /// The pairs include the values of SimulationOptions::set, with keys such as `set /populations/0/count`. If
  /// `set` has several values for one JSON pointer, only the last is listed. Values that are appended to a
  /// list (their pointer ends in `/-`) are all listed: the first with the key `set /models/-`, the second
  /// with `set /models/- #2`, and so on.
  std::vector<std::pair<std::string, std::string>> effective_options() const;

  /// The shell command that repeats the run from its file with the acts in `session`, a session file, such as
  /// `troupe run cave.world --seed 7 --session cave.session.jsonl`, or `troupe resume ...` for a resumed run.
  /// Empty if a program built the world.
  std::string command(const std::filesystem::path& session) const;

  /// The condition in the world's list `stop_when` that ended the run, such as `coverage >= 0.9`
  /// (docs/experiments.md); empty while no condition holds. Conditions are evaluated after each step, and
  /// once when a run is resumed. At tick 0 they are not evaluated, and the result is empty.
  std::optional<std::string> stopped() const;

  /// Advances the world by one tick, in the phases intervene, sense, actuate, decide, move and index. step()
  /// ignores stop conditions: it also advances a run that stopped() reports as ended. Throws StepError, a
  /// std::runtime_error that names tick and robot, if a commanded speed is not finite or if a controller or a
  /// device throws. Exceptions of an on_phase() callback pass through unchanged. After an exception the state
  /// is incomplete. Until reset(), all functions that read or advance the state then throw std::logic_error,
  /// also those of models, swarms and observers of this simulation.
  void step();
  /// Steps until `seconds` more of simulated time have passed, or until a stop condition ends the run
  /// (stopped()). The time is rounded up to whole ticks, but with a tolerance for rounding errors: 0.07 s are
  /// 7 ticks of 0.01 s, although 0.07 / 0.01 is slightly above 7 in floating point. The tolerance is 1e-9 of
  /// `seconds` or of a tick, whichever is longer, but at most half a tick. Makes no step if a stop condition
  /// already holds. Throws std::invalid_argument if `seconds` is negative, NaN or more than 1e12.
  void run_for(double seconds);
  /// Makes steps, and calls `done` after each step. Returns true as soon as `done` returns true. Returns
  /// false if `at_most_s` seconds of simulated time (rounded as in run_for()) pass first, or if a stop
  /// condition ends the run first (stopped()). If a stop condition already holds, makes no step and returns
  /// false. Throws std::invalid_argument, and makes no step, if `done` is null, or if `at_most_s` is
  /// negative, NaN or more than 1e12.
  bool run_until(const std::function<bool(const Simulation&)>& done, double at_most_s);
  /// Adds a callback that is called at the end of every step, also in run_for() and run_until(). Before the
  /// callbacks are called, the stop conditions have been evaluated, and the recording of record() has
  /// received the tick. Callbacks are called in the order in which they were added. A null callback removes
  /// all callbacks that have no owner.
  ///
  /// A callback may do everything that a program may do between two steps (read, command, set_poses(),
  /// spawn(), remove(), save()). Only step(), reset() and on_tick() are not allowed: they throw
  /// std::logic_error. A callback must not destroy the simulation, move it, or assign to it; nor may the
  /// other callbacks below. If a callback throws, step() passes the exception on and calls no further
  /// callbacks; the state is that after a complete tick.
  void on_tick(std::function<void(Simulation&)> callback);
  /// Adds a callback as the other on_tick() does, for as long as the object `owner` exists: when `owner` has
  /// expired, the callback is not called again, and the next step removes it. `on_tick(nullptr)` does not
  /// remove it. Throws std::invalid_argument for a null callback.
  void on_tick(std::function<void(Simulation&)> callback, std::weak_ptr<const void> owner);
  /// Sets the callback that is called in every step at the end of the phase intervene, after the
  /// interventions and faults of the world file. tick() is then still the number of the previous tick. The
  /// callback may do everything that a program may do between two steps, except save(), and may call act().
  /// In the callback, save() throws std::logic_error, because a run that is resumed from the checkpoint would
  /// repeat the interventions and faults of this tick. step(), reset(), on_tick() and before_tick() throw
  /// std::logic_error there, too. If the callback throws, step() passes the exception on, and the state is
  /// then incomplete, as described at step(). A second call replaces the callback; a null callback removes
  /// it.
  void before_tick(std::function<void(Simulation&)> callback);
  bool has_before_tick() const;  ///< whether a callback of before_tick() is set
  /// Sets the callback that is called at the beginning of every step, before the interventions and faults of
  /// the world file. The state is that after the previous tick, or that after a reset with the changes that
  /// the program has made since. A live view (live/view.hpp) uses this callback. The callback may do
  /// everything that a program may do between two steps, except step(), reset(), on_tick() and before_step(),
  /// which throw std::logic_error. If the callback throws, step() passes the exception on and computes
  /// nothing. A second call replaces the callback; a null callback removes it.
  void before_step(std::function<void(Simulation&)> callback);
  /// Applies an act to the running world: a change that a user or a program requests, such as moving,
  /// removing or steering a robot (docs/live.md). Call it between two steps, or in the callback of
  /// before_tick(). A hold, the act that steers a robot instead of its controller, lasts until another act
  /// releases the robot, until the robot leaves the world, or until reset(). Checkpoints contain holds.
  /// Throws ActRefused (troupe/acts.hpp), and changes nothing, if the act is impossible.
  void act(const engine::Act& act);
  /// Returns to the state after loading, or after the last reset(seed), bit for bit. The tick is 0, and the
  /// same run follows. Models, swarms, callbacks and subscriptions stay valid. Commanded speeds and the
  /// changes of set() are discarded, except those that a checkpoint contained (set()), and a recording of
  /// record() is closed. After a step that threw, call reset() to continue.
  ///
  /// reset() reads no file, and allocates no memory unless the world has `stop_when`. Therefore a program can
  /// run thousands of trials of one world for little more than the cost of their steps.
  void reset();
  /// Returns to the state that the world has after loading with the given seed, bit for bit. Populations are
  /// placed again, and all random numbers depend on the new seed. In a world made from a WorldSpec, which has
  /// no placement rules, all bodies start at the same places as before. Apart from this, reset(seed) is like
  /// reset(), but it allocates memory. Throws InputError, and changes nothing, if the placement rules find no
  /// place for a robot with this seed. Throws std::logic_error for a run that was resumed, because a
  /// checkpoint does not store the placement rules.
  void reset(std::uint64_t seed);
  /// As reset(seed), but the models in `starts` begin at these poses, in the world frame, m and rad, instead
  /// of the places that the world gives them: for example, to begin a trial in a state that a program has
  /// chosen. All other bodies are placed as by reset(seed). Static geometry may be in `starts`, too. A model
  /// may overlap other bodies, as after Model::set_pose(). A later reset() returns to this state; a later
  /// reset(seed) returns to the places that the world gives.
  ///
  /// Throws what reset(seed) throws, std::invalid_argument for a pose that is not finite or outside the
  /// bounds of the world, and for a body that is not in the world at the start, and std::logic_error for a
  /// part of a body and for a model of another simulation. Changes nothing in these cases.
  void reset(std::uint64_t seed, std::span<const std::pair<Model, Pose>> starts);
  /// Makes another simulation of the same world at tick 0, as if it had been loaded with this seed. Reads no
  /// file. The new simulation may outlive this one and is computed by one rank. It has no callbacks, no
  /// subscriptions, no warnings() and none of the changes that set() has made. threads: number of worker
  /// threads, as in SimulationOptions. Throws as reset(seed) does.
  Simulation another(std::uint64_t seed, unsigned threads) const;

  /// Saves the whole state between two steps in a checkpoint, one HDF5 file. To resume the run, resume()
  /// needs no other files, except the plug-ins and scripts of the run. Subscriptions and commanded speeds are
  /// saved, callbacks are not.
  ///
  /// The file is written under a temporary name and renamed once it is complete and on the disk. If save()
  /// throws or the process dies, a previous file `checkpoint` therefore remains unchanged.
  ///
  /// Throws std::runtime_error, `run.h5: error: ...`, if the file cannot be written, if it is a file that the
  /// simulation was read from (world, image, plug-in, ...), if the ending of its name is that of another
  /// format than HDF5 (.csv, .html, .json, .mp4, .pdf, .png or .svg), or if the build has no HDF5. Throws
  /// std::logic_error in a callback of before_tick(). Passes on exceptions of callbacks of on_save().
  ///
  /// If the robots are distributed among ranks (SimulationOptions::distribute), fetches all robots.
  void save(const std::filesystem::path& checkpoint) const;

  /// Sets a callback that provides data of the program for the checkpoint, such as the state of an observer.
  /// Each save() calls `memory` and stores the returned bytes, which may be none, under `name`; after
  /// resume(), saved_memory() returns them. A null callback removes the callback of this name. Throws
  /// std::invalid_argument for the name `holds` and for names that begin with `stop_when`: Troupe stores data
  /// of its own under these names.
  void on_save(const std::string& name, std::function<std::vector<std::byte>()> memory);
  /// The bytes that save() stored under `name` in the checkpoint that the run was resumed from (see
  /// on_save()); std::nullopt if no callback had this name, or if the run was not resumed.
  std::optional<std::vector<std::byte>> saved_memory(const std::string& name) const;

  /// The tick of the checkpoint that the run was resumed from; std::nullopt if the run was not resumed.
  std::optional<std::uint64_t> resumed_at_tick() const;

  double time_s() const;       ///< simulated time, s
  std::uint64_t tick() const;  ///< number of completed ticks
  double tick_s() const;       ///< length of a tick, s
  /// Number of robots that are in the world now.
  std::size_t robots() const;
  std::uint64_t seed() const;  ///< seed of all random numbers of the run
  std::string title() const;   ///< title in the world file, or else the name of the file
  /// The time at which the world file ends the run (`quit_time_s`), s; empty if the world file states no
  /// time. run_for() and step() do not end at this time.
  std::optional<double> quit_time_s() const;

  /// Finds a model by name: a body ("r0"), or a part that is mounted on a body ("r0.ranger:1"). The name is
  /// the one in the world file, or else the one that the simulator Stage would generate (Model::name()). If
  /// there is no such model, throws std::out_of_range, whose text suggests a similar name if there is one.
  Model find(std::string_view name);
  /// The body with this id. Sensors and cast() report such ids. Throws std::out_of_range if there is no such
  /// body.
  Model model(BodyId id);
  /// Casts a ray and returns the first surface that it meets, with exact intersections also in worlds whose
  /// rangers use the occupancy grid. If the ray meets nothing, RayHit::range_m is range_max and RayHit::body
  /// is not valid.
  /// from       start of the ray, m, and its direction, rad, in the world frame; the ray stays at the height
  ///            from.z
  /// range_max  length of the ray, m; the ray does not meet surfaces at this distance or farther
  /// without    a body that the ray ignores, for rays that start within a robot. The ray also ignores all
  ///            bodies that move together with this body because one carries another, such as a box in the
  ///            gripper of the robot. Null, or static geometry: the ray ignores no body
  /// meets      surfaces that rangers detect (ranger_return >= 0) and whose z interval, including both ends,
  ///            contains from.z; both sides of a surface count. The distance is computed in double precision,
  ///            so it may differ from the float32 reading of a ranger in its last bits
  /// ties       if two surfaces are at the same distance, the ray meets the surface of the body with the
  ///            lower id; on one body, it meets the surface of the part with the lower index
  /// errors     std::invalid_argument if `from` is not finite, or if range_max is below 0 or above 300 km;
  ///            std::logic_error if `without` is a model of another simulation
  /// threads    several threads may cast rays at once, between two steps; nothing is changed
  RayHit cast(const Pose& from, double range_max, const Model* without = nullptr) const;
  /// Returns a group of robots, in the order of their ids (troupe/swarm.hpp). of: name of a type, of a
  /// population or of one robot; empty: all robots. The group is empty if the type or population has no
  /// robot. Throws std::out_of_range, with the known names, for an unknown name.
  Swarm swarm(std::string_view of = {});
  /// Returns a group that contains only this robot, even if a type or a population has the same name. Throws
  /// std::out_of_range if the body of the model has no drive, and std::logic_error for a model of another
  /// simulation.
  Swarm swarm(const Model& robot);
  /// Places many models, each as Model::set_pose() does. This costs little more than placing one model,
  /// because the spatial index of the bodies is rebuilt only once. If a model occurs twice, its last pose
  /// counts. If one pose is invalid, set_poses() throws the error of Model::set_pose() and moves no model.
  /// Throws std::logic_error for a model of another simulation.
  void set_poses(std::span<const std::pair<Model, Pose>> poses);
  /// Spawns a robot between two steps: places the next unborn body of a population's reserve at a pose in the
  /// world frame, m and rad. From the next step on its controller runs and sensors detect it. Returns
  /// std::nullopt if the body would be outside the bounds of the world or overlap a wall or another body that
  /// is an obstacle, or if the reserve is used up. Throws std::out_of_range for a population without a
  /// reserve, and std::invalid_argument for a pose that is not finite. Each birth rebuilds the spatial index
  /// of all bodies.
  std::optional<Model> spawn(std::string_view population, const Pose& pose);
  /// Number of bodies that spawn() can still add to a population. Throws std::out_of_range for a population
  /// without a reserve.
  std::size_t unborn(std::string_view population) const;
  /// Removes a body from the world for good, between two steps. Other bodies no longer collide with it or
  /// sense it. Bodies that it carried stay where they are. Its id is never used again. Does nothing if the
  /// body is not in the world. Each call rebuilds the spatial index of all bodies.
  ///
  /// Throws std::logic_error for a part of a body, for static geometry, for a model of another simulation,
  /// and in a world whose bodies cannot be removed. Bodies can be removed if at least one of these conditions
  /// holds:
  /// - The option SimulationOptions::mortal or `"mortal": true` in the world file is set.
  /// - A population has a reserve.
  /// - The world has a device or an intervention that removes bodies.
  void remove(const Model& model);
  /// Disables a body between two steps: its controller, drive, sensors and other devices stop; sensors keep
  /// their last readings. The body stays where it is, and other bodies still collide with it and sense it.
  /// Returns false if the body is already disabled or is not in the world.
  ///
  /// Throws std::logic_error for a part of a body, for static geometry, for a model of another simulation,
  /// and in a world whose bodies cannot be disabled. Bodies can be disabled if at least one of these
  /// conditions holds:
  /// - The option SimulationOptions::mortal or `"mortal": true` in the world file is set.
  /// - The world has faults.
  /// - The world has an intervention `disable` or `enable`.
  bool disable(const Model& model);
  /// Enables a disabled body, between two steps; it continues with its last commands. Returns false if the
  /// body is not disabled or is not in the world. Throws as disable() does.
  bool enable(const Model& model);
  /// Changes parameters of a type, for all its bodies, between two steps. The intervention `set` of a world
  /// file does the same (docs/experiments.md). The change lasts until reset(). Checkpoints contain it as an
  /// intervention `set`, so in a run that is resumed from such a checkpoint, reset() does not discard it: it
  /// is made again at the same time.
  ///
  /// type     name of the type
  /// setting  JSON object with the new values; other parameters keep their values. Examples:
  ///            {"drive": {"velocity_max_x_mps": 0.5}}
  ///            {"device": {"name": "eye", "range_max_m": 3}}
  ///            {"controller": {"kind": "wander", "cruise_speed_mps": 0.2}}
  ///
  /// Throws std::invalid_argument, and changes nothing, if there is no such type, if the type has no such
  /// parameter, if a value is not allowed, or if the parameter determines the layout of the state, such as
  /// the number of beams of a ranger.
  void set(std::string_view type, std::string_view setting);
  /// The present parameters of a type, with the changes by set() and by interventions `set`. The result is a
  /// JSON list with one object for the drive and one for each device and controller that has parameters. The
  /// objects have the form of the argument `setting` of set(). Infinite values, and lists of objects such as
  /// the transducers of a ranger, are left out. Throws std::out_of_range, with the known names, if there is
  /// no such type.
  std::string parameters(std::string_view type) const;
  /// Names of all robots in the world, in the order of their ids.
  std::vector<std::string> robot_names() const;
  /// Makes all sensors of a body run, as the function Subscribe of the simulator Stage does. model: name of
  /// the body or of one of its parts. Without this call, a sensor runs only if the world file makes it run
  /// (`active` in JSON, `alwayson` in Stage worlds) or if the robot's controller reads it. Call subscribe()
  /// before the first step: later calls throw std::logic_error. Throws std::out_of_range for an unknown
  /// model.
  void subscribe(std::string_view model);

  /// Starts to record this run in a file (troupe/recording.hpp). The state is recorded in each tick that is a
  /// multiple of the recording interval, from the current tick on, until stop_recording(), reset() or the
  /// destruction of the simulation. Throws as the constructor of Recording does. Throws std::logic_error if a
  /// recording is already running. Throws std::runtime_error if the file is one that the simulation was read
  /// from (world, image, plug-in, ...).
  void record(const std::filesystem::path& file);
  /// Starts to record this run, as the other record() does, with the fields, the interval and the other
  /// options that `options` states.
  void record(const std::filesystem::path& file, const RecordingOptions& options);
  /// Closes the recording that record() started; other HDF5 tools can then read the file. Throws
  /// std::runtime_error if the file cannot be written. Does nothing if no recording is running.
  void stop_recording();

  /// Returns a 64-bit hash of the whole state, the member `state` of hashes(). Simulations with equal states
  /// have equal hashes (docs/determinism.md). Throws std::logic_error during a step, for example in a
  /// controller, and in a function that Swarm::for_each() calls.
  std::uint64_t state_hash() const;
  /// The hash of the state, and the hashes of four groups of the components (tables) of which the state
  /// consists.
  struct Hashes {
    std::uint64_t state = 0;     ///< the sum of the four hashes below, modulo 2^64
    std::uint64_t pose = 0;      ///< poses, carried bodies, which bodies are in the world
    std::uint64_t velocity = 0;  ///< velocities, commands of drives and devices, blocked motions
    std::uint64_t sensor = 0;    ///< readings of sensors, and the state of other devices
    std::uint64_t memory = 0;    ///< memory of controllers, odometry, faults and disabled bodies
  };
  Hashes hashes() const;  ///< hashes of the current state
  /// The first lines of a hash log (a file with the hashes of every tick), each `# key: value`. They state
  /// version and options, so they may differ between logs of runs with equal states.
  std::string hash_log_header() const;
  /// The line of a hash log for the current tick: `TICK STATE pose=... velocity=... sensor=... memory=...`,
  /// with hashes as 16 hexadecimal digits.
  std::string hash_log_line() const;

  Statistics statistics() const;  ///< numbers that describe the run, computed in a loop over all robots
  /// The sums of the energies of all power packs of the world, J; all 0 if there is no pack. The packs of
  /// bodies that are not in the world add nothing. Energy::infinite is true if at least one pack is infinite,
  /// and Energy::charging is true if at least one pack is charging.
  Model::Energy energy() const;
  unsigned threads() const;                ///< number of worker threads, per rank
  unsigned ranks() const;                  ///< number of ranks, threads or processes, that compute the world
  RankStatistics rank_statistics() const;  ///< numbers that describe the messages between ranks
  /// For each rank, the number of its bodies and the times of its phases in the last tick, in the order of
  /// the ranks; empty with one rank. The times are 0 if neither SimulationOptions::rank_clock nor
  /// SimulationOptions::processes is set. Valid until the next step.
  std::span<const RankWork> rank_work() const;
  /// Returns what each rank has counted so far, in the order of the ranks; empty with one rank. Throws
  /// std::logic_error during a step, because it exchanges messages with the other ranks.
  std::vector<RankCounts> rank_counts();
  /// Sets a callback, for example to measure the time of phases. It is called with the phase when a phase of
  /// a tick begins, and with std::nullopt when the tick ends, on the thread that calls step(). Set it between
  /// two steps. A second call replaces the callback; a null callback removes it.
  ///
  /// The callback must not change the simulation, because it is called within a step. There, the functions
  /// of Simulation, Swarm and Model that step, reset, save or record the simulation, that change or command
  /// models, or that set callbacks, and Swarm::for_each(), throw std::logic_error.
  void on_phase(std::function<void(std::optional<Phase>)> callback);
  /// Sets a callback for profilers. Parallel loops are divided into tasks for the worker threads. The
  /// callback is called when a task of a loop begins (`begins` is true) and when the task ends (false);
  /// `task` is the index of the task in its loop. Worker threads call it concurrently, so it must be
  /// thread-safe. It must not throw. Set it between two steps. A second call replaces the callback; a null
  /// callback removes it.
  void on_task(std::function<void(std::size_t task, bool begins)> callback);
  /// Sets a callback, for example to measure the time of parallel loops. It is called on the thread that
  /// calls step() when a parallel loop begins (true) and when it ends (false), also for loops that run
  /// between two steps, such as those of hashes and measures. It must not throw. Set it between two steps. A
  /// second call replaces the callback; a null callback removes it.
  void on_loop(std::function<void(bool begins)> callback);

  /// The world as the engine stores it (engine/world/world.hpp): its types, state tables and callbacks, for
  /// tools that compare or save states. The reference is valid while the simulation lives.
  engine::World& world();
  const engine::World& world() const;  ///< the same world, read-only
  /// The registry that this world was made with: the kinds of sensors, other devices, drives, controllers and
  /// so on. The reference is valid while the simulation lives.
  const engine::Registry& registry() const;

  /// Draws the world from above into a file, whose name must end in .png, .svg or .pdf. width, height: size
  /// in pixels; 0 or less: the default, 1280 x 720. An existing file is replaced. Throws InputError for
  /// another name. Throws std::runtime_error if OSMesa and EGL (for PDF: cairo) are missing, if the build
  /// has no renderer, if the file cannot be written, or if it is a file that the simulation was read from
  /// (world, image, plug-in, ...).
  void snapshot(const std::filesystem::path& png, int width = 1280, int height = 720) const;
  /// Draws the world into a file with the camera, size and layers of `options` (troupe/pictures.hpp); the
  /// ending of the name selects the format, as in the other snapshot(). Throws std::runtime_error as the
  /// other snapshot() does, and InputError if `options` name a camera, layer, background, model or field that
  /// does not exist, or for an SVG or PDF file of a view that is not from straight above.
  void snapshot(const std::filesystem::path& png, const PictureOptions& options) const;
  /// Returns a picture of the world from above: 8-bit RGB, three bytes per pixel, row by row from the top.
  /// width, height: size in pixels. Throws std::runtime_error if OSMesa and EGL are missing, if the size
  /// exceeds the limit of Mesa, or if the build has no renderer, and std::invalid_argument for a width or
  /// height below 1. Do not call picture() or snapshot() from two threads at once: they share a renderer.
  std::vector<std::uint8_t> picture(int width = 1280, int height = 720) const;
  /// Returns a picture with the camera, size and layers of `options`: 8-bit RGB, three bytes per pixel, row
  /// by row from the top. A width or height of 0 or less means the default of PictureOptions. Throws
  /// std::runtime_error as the other picture() does, InputError if `options` name a camera, layer,
  /// background, model or field that does not exist, and std::invalid_argument for the background
  /// `transparent`, which RGB cannot represent.
  std::vector<std::uint8_t> picture(const PictureOptions& options) const;

 private:
  friend class Model;
  struct Impl;
  explicit Simulation(std::shared_ptr<Impl> impl);
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
  std::shared_ptr<Impl> impl_;
};

/// Returns one line that states the version of Troupe, the compiler and its flags, the processor
/// architecture, and whether assertions are on.
std::string version_line();

}  // namespace troupe
