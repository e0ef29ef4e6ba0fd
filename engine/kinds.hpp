#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "base/result.hpp"
#include "engine/effects.hpp"
#include "engine/energy.hpp"
#include "engine/fault_kind.hpp"
#include "engine/fields.hpp"
#include "engine/localization.hpp"
#include "engine/measure_kind.hpp"
#include "engine/mount.hpp"
#include "engine/state_table.hpp"

#include <any>
#include <array>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

class World;
struct Frame;
struct Links;
struct Registry;
struct TypeSpec;
struct WorldSpec;

/// The engine calls sensors, drives and controllers through tables of functions and includes none of them.
/// When the world is built, a kind converts its parameters to data of a type of its choice (`prepare`). It is
/// then called for batches of rows. Those calls run on several threads at once, so they may write only to
/// their arguments. An exception ends the step and propagates from World::step().

/// A model kind: a kind of model in Stage world files. Part of the registry so that loaders share the
/// defaults.
struct ModelKind {
  std::string_view name;                ///< name in Stage files: "position"
  std::string_view text;                ///< one sentence for `troupe describe`
  Eigen::Vector3d size{0.4, 0.4, 1.0};  ///< default size x, y, z, m
  Color color{1, 0, 0, 1};              ///< default colour
  bool has_default_body = true;         ///< false: a model without blocks has no body
  std::string_view device;  ///< device kind that each model of this kind is; empty: it is no device
  FieldTable params;        ///< of that device, or of the model itself
};

/// Rows of one type whose device senses or acts in a tick, with their data. i is an index into `rows`.
struct DeviceBatch {
  const World& world;          ///< the last committed state
  const std::any& data;        ///< result of DeviceKind::prepare
  std::span<const Row> rows;   ///< rows of the batch; all of one type
  StateTable& state;           ///< the device's rows, by slot; hooks may write to those of `rows`
  const StateTable* commands;  ///< commands from controllers, by slot; null if the kind takes none
  Effects& effects;            ///< receives effects on other bodies: see emit()
  Links& links;                ///< receives goals of joints: see move_joint()
  std::uint32_t device = 0;    ///< its index within the type
  std::uint32_t stream = 0;    ///< of its random numbers
  double period_s = 0;         ///< time since it last ran

  BodyId body(std::size_t i) const;       ///< id of the body
  std::size_t slot(std::size_t i) const;  ///< of the row in `state` and `commands`
  /// The random numbers of a row in this tick.
  Random random(std::size_t i) const;
  /// An independent random stream per name, for kinds that wrap another kind: their draws do not disturb
  /// those of the wrapped kind.
  Random random(std::size_t i, std::string_view name) const;
  /// Pose in the world of the body's frame, as moved by the joint that the device is mounted on.
  Mount mount(std::size_t i) const;
  /// Displacement from rest of the n-th joint that the device moves.
  const Pose& joint(std::size_t i, std::size_t n) const;
  /// In `act`: sets the goal of a joint in this tick, relative to rest. Joints of one device, and of all
  /// bodies of one tree, that move in the same round move together or not at all.
  void move_joint(std::size_t i, std::size_t n, const Pose& to) const;
  /// In `joints_moved`: whether the joint had a goal in this tick.
  bool asked_joint(std::size_t i, std::size_t n) const;
  /// In `joints_moved`: whether the joint moved.
  bool moved_joint(std::size_t i, std::size_t n) const;
  /// Emits an effect, which DeviceKind::apply applies after all bodies have moved. Throws std::length_error
  /// if rows emit more than `Prepared::most_effects` each. sequence: order among the effects of a row in a
  /// tick; verb, payload: defined by the kind; target: may be invalid
  void emit(std::size_t i, std::uint32_t sequence, std::uint32_t verb, BodyId target,
            const std::array<double, 4>& payload = {}) const {
    effects.emit({body(i), device, sequence, verb, target, payload});
  }
  /// Requests the birth of the next body of a reserve at a pose, m and rad, world frame. DeviceKind::born
  /// receives the result.
  void emit_birth(std::size_t i, std::uint32_t sequence, std::uint32_t reserve, const Pose& at) const {
    effects.emit({body(i), device, sequence, k_birth, BodyId(), {at.x, at.y, at.z, at.heading}, reserve});
  }
  /// Requests the death of a body. The device must have Prepared::ends_lives.
  void emit_death(std::size_t i, std::uint32_t sequence, BodyId whose) const {
    effects.emit({body(i), device, sequence, k_death, whose});
  }
};

/// A fan of beams of a ranging sensor that start at one place.
struct Transducer {
  std::size_t first = 0;        ///< index of its first reading among those of the sensor
  std::size_t samples = 1;      ///< number of its readings
  Pose pose_sensor_transducer;  ///< origin of the beams and heading of their middle; sensor frame
  double range_max = 0;         ///< m
  double fov = 0;               ///< from the first beam to the last, rad; the width of a single beam
};

/// The images of a camera: their size, and which percepts hold them.
struct Camera {
  std::size_t width = 0;   ///< pixels
  std::size_t height = 0;  ///< pixels
  double range_far = 0;    ///< m: depth of a pixel that shows no surface
  std::size_t color = 0;   ///< percept: u8 [red green blue opacity] per pixel, row by row from the upper left
  std::size_t depth = 1;   ///< percept: f32 per pixel, m along the optical axis
};

/// The marked parts (Returns::fiducial) that a sensor detects.
struct SoughtMarks {
  std::int32_t key = 0;       ///< Returns::fiducial_key of the parts
  bool at_any_height = true;  ///< false: only parts that the height of the sensor intersects
};

/// Flags that a device holds.
struct HeldFlags {
  std::size_t count = 0;       ///< number of flags that it holds
  std::uint64_t received = 0;  ///< number that others gave it since tick 0
};

/// The device of one row, for viewers.
struct DeviceView {
  const World& world;       ///< the last committed state
  const std::any& data;     ///< result of DeviceKind::prepare
  const StateTable& state;  ///< the device's rows, by slot
  std::size_t slot = 0;     ///< of the row in `state`
  std::uint32_t body = 0;   ///< index into Frame::mobile
  Pose pose_world_device;   ///< as moved by joints

  /// Converts a point from the device frame to the world frame, m.
  Eigen::Vector3d at(double x, double y, double z) const;
};

/// The layer of a frame in which devices of a kind are drawn.
enum class FrameLayer : std::uint8_t {
  none,    ///< not drawn
  sights,  ///< Frame::sights
  blobs,   ///< Frame::blobs
  grips,   ///< Frame::grips
};

/// A kind of device: a sensor, which only reads the world, or another device (gripper, light, power pack),
/// which takes commands and acts. A device is mounted on a part of a body and has a state of its own.
struct DeviceKind {
  std::string_view name;  ///< name in files: "ranger"
  std::string_view text;  ///< one sentence for `troupe describe`
  FieldTable params;      ///< its parameters
  /// Names of the joints that it moves. A single joint may have an empty name.
  std::vector<std::string_view> joints;
  /// Whether it can pick up other bodies.
  bool carries = false;
  /// Whether it is a drive, which controllers of its part, and of parts mounted on that, command. Its
  /// commands are a Command (command_fields), and its state begins with its estimated pose.
  bool drives = false;
  /// A solid of a device, with its joints at rest.
  struct Fixture {
    Solid solid;              ///< device frame
    std::int32_t joint = -1;  ///< index of the device's joint that moves the solid; -1: none
  };
  /// Solids that the device adds to its body. Null: none.
  std::vector<Fixture> (*body)(const Record& params) = nullptr;
  /// A device compiled from its parameters: the data of its hooks and the layout of its state.
  struct Prepared {
    std::any data;                     ///< the argument `data` of the hooks
    std::vector<StateField> percepts;  ///< fields of the device's state table
    std::size_t percept_bytes = 0;     ///< size of the struct of a row (memory_fields); 0: no struct
    std::vector<StateField> commands;  ///< commands from controllers: fields of a struct (memory_fields)
    std::size_t command_bytes = 0;     ///< size of that struct; 0: it takes no commands
    double reach_m = 0;                ///< radius of the declared query about the body's origin
    std::size_t beams = 0;             ///< rays cast each time it runs
    std::size_t most_effects = 0;      ///< largest number that a row may emit in a tick
    bool ends_lives = false;           ///< its effects may be deaths
    double watts = 0;                  ///< power drawn from its supply while it runs
    std::vector<Pose> joints;          ///< poses of its joints at tick 0, relative to rest; empty: at rest
    double joint_reach_m = 0;          ///< bound on how far its joints move from rest
    /// Heading of each reading in the sensor frame, rad. Empty, as are `transducers`, if the sensor is no
    /// ranger. Percept 0 of a ranger holds the ranges.
    std::vector<double> bearings;
    std::vector<Transducer> transducers;  ///< in the order of the readings; together they have all of them
    std::optional<Camera> camera;         ///< for a sensor whose readings are images
    std::optional<SoughtMarks> seeks;     ///< for a sensor that detects marked parts
  };
  /// Compiles the parameters, which are within the limits of their table. A pure function that need not
  /// throw.
  Prepared (*prepare)(const Record& params, const Pose& pose_body_device);
  /// Called once after `prepare`: completes the data from the type and the part that carries the device. The
  /// error says what is wrong with them. Null: not needed.
  Result<> (*bind_part)(std::any& data, const TypeSpec& type, std::uint32_t part) = nullptr;
  /// Called once after `bind_part`: completes the data from the world. The error says what is wrong with it.
  /// Null: not needed.
  Result<> (*bind_world)(std::any& data, const WorldSpec& world) = nullptr;
  /// Sets the state of a row when its life begins, at tick 0 or later. All bytes are 0 before. Null: they
  /// stay 0.
  void (*start)(const std::any& data, StateTable& state, std::size_t slot) = nullptr;
  /// In the sense phase: writes the percepts of every row of the batch. Reads only the last committed state.
  /// Returns the number of rays cast. Null: it senses nothing.
  std::uint64_t (*sense)(const DeviceBatch& batch) = nullptr;
  /// Before the controllers decide, when drives run: executes the commands of the previous tick. Null: it has
  /// no actions.
  void (*act)(const DeviceBatch& batch) = nullptr;
  /// After bodies and joints have moved, if any joint of the batch had a goal: reads the outcome of its
  /// joints (moved_joint). Null: not needed.
  void (*joints_moved)(const DeviceBatch& batch) = nullptr;
  /// After the bodies have moved: applies one effect of this kind. Effects are applied one by one, in the
  /// order of (source, device, sequence), and see the results of earlier ones. Null: it has no effects.
  void (*apply)(World& world, const std::any& data, const Effect& effect) = nullptr;
  /// After all other effects of the tick: receives the result of a birth that its row requested. Null: not
  /// needed.
  void (*born)(World& world, const std::any& data, const Effect& effect, const Birth& birth) = nullptr;

  /// For power supplies: whether a row is empty, so that the devices it supplies stop. A supply serves its
  /// part and the parts mounted on it, except those with a supply of their own; on the root part, also the
  /// drive. Null: it supplies no power.
  bool (*is_spent)(const std::any& data, const StateTable& state, std::size_t slot) = nullptr;

  bool needs_supply = false;  ///< it is an error if no supply serves its part
  /// Energy of a row. Null: it stores no energy.
  Energy (*energy)(const StateTable& state, std::size_t slot) = nullptr;
  /// Flags of a row. Null: it holds no flags.
  HeldFlags (*flags)(const StateTable& state, std::size_t slot) = nullptr;

  /// Its state begins with the colour that its part shows: three f32, red, green and blue, in a field named
  /// k_shown_color (engine/shown_color.hpp), by which recordings find it.
  bool shows_color = false;
  FrameLayer layer = FrameLayer::none;  ///< layer that `draw` adds to
  /// Adds the drawing of a row to `layer`. Called for sensors only if they have sensed and still run. Null
  /// without a layer.
  void (*draw)(const DeviceView& view, Frame& frame) = nullptr;

  /// True if the device only senses.
  bool is_sensor() const { return act == nullptr && apply == nullptr && born == nullptr; }
};

/// The meaning of the numbers of a command.
enum class ControlMode : std::uint8_t {
  velocity,      ///< speeds, m/s and rad/s; for a `car` turn is the steering angle, rad
  acceleration,  ///< m/s^2 and rad/s^2; for a `car` turn is the steering angle, rad
  position,      ///< a goal in the frame of the estimate, m and rad
};
inline constexpr std::size_t k_control_modes = 3;  ///< values of ControlMode

/// The command of a controller to its drive, in the body frame (a goal: in the frame of the estimate). To
/// assign `{x, y, turn}` commands a speed; to assign one number keeps the mode.
struct Command {
  double x = 0;                              ///< forward
  double y = 0;                              ///< left
  double turn = 0;                           ///< counter-clockwise
  ControlMode mode = ControlMode::velocity;  ///< meaning of the numbers
  std::uint32_t off = 0;  ///< devices that the controller has switched off: BodyType::Device::switch_bit
};

/// The members of Command as state fields.
std::vector<StateField> command_fields();

/// The velocity that a drive gives its body.
struct Velocity {
  double x = 0;     ///< m/s, body frame, forward
  double y = 0;     ///< m/s, body frame, left
  double turn = 0;  ///< rad/s
};

/// Drives of robots of one type that are due in a tick. Sizes are equal.
struct DriveBatch {
  std::span<const Command> commands;  ///< one per robot
  std::span<Velocity> velocities;     ///< in: of the last tick, if there are `estimates`; out: of this tick
  std::span<const Pose> estimates;    ///< estimated poses; empty if all commands are speeds
  double elapsed_s = 0;               ///< time since they were last due
};

/// A kind of drive, which computes velocities from commands.
struct DriveKind {
  std::string_view name;  ///< name in files: "diff"
  std::string_view text;  ///< one sentence for `troupe describe`
  FieldTable params;      ///< its parameters
  /// Compiles the parameters to the argument `data` of the other hooks.
  std::any (*prepare)(const Record& params);
  /// Checks that the parameters are consistent. The error says what is wrong with them.
  Result<> (*check)(const Record& params);
  /// Computes the velocities of a batch from the commands, within the limits of the drive.
  void (*drive)(const std::any& data, const DriveBatch& batch);
  /// Velocity of a robot until its drive is due for the first time. Null: 0.
  Velocity (*start)(const std::any& data) = nullptr;
  /// Parameters that the engine itself implements.
  ///@{
  /// The pose estimation of its robots, or why the parameters are inconsistent. Null: the true pose.
  Result<Localization> (*localization)(const Record& params) = nullptr;
  /// The number of pushable bodies that a robot can push at once, 0 to k_most_pushed. Null: 0.
  std::int64_t (*pushes)(const Record& params) = nullptr;
  ///@}
};

/// The largest number of sensors and other devices that one controller can use.
inline constexpr std::size_t k_most_devices_read = 16;

/// The state of one sensor, or other device, of one robot.
class Readings {
 public:
  Readings() = default;
  /// A row of a device's table, which must outlive this.
  Readings(const StateTable& table, std::size_t slot) : table_(&table), slot_(slot) {}
  /// A field, by its index among the kind's percepts; one value per column.
  template <class T>
  std::span<const T> field(std::size_t f) const {
    return table_->cell<T>(slot_, f);
  }
  /// The whole row, if the kind's percepts are the members of a struct.
  template <class State>
  const State& as() const {
    return table_->as<State>(slot_);
  }

 private:
  const StateTable* table_ = nullptr;
  std::size_t slot_ = 0;
};

/// The inputs of one robot's controller in a tick.
struct Percept {
  std::uint64_t tick = 0;  ///< the tick being decided; 1 is the first
  double time_s = 0;       ///< world time at the end of the tick
  double tick_s = 0;       ///< length of a tick, s
  std::uint32_t body = 0;  ///< id of the robot
  /// The sensors and other devices that the controller chose in `prepare`, in that order.
  std::span<const Readings> devices;
  /// Estimated pose of the robot: engine/localization.hpp.
  Pose estimate;

  /// Ranges of a ranger, m.
  std::span<const float> ranges(std::size_t ranger) const { return devices[ranger].field<float>(0); }
};

/// The outputs of one robot's controller. They hold the last values.
struct Actions {
  Command& command;  ///< of its drive
  /// Command structs of the chosen devices, in the order of Percept::devices; null for devices that take no
  /// commands.
  std::span<std::byte* const> devices;
  /// Bits of the chosen devices in Command::off.
  std::span<const std::uint32_t> switches;

  /// Switches a chosen device on or off, from the next tick on. A device that is off does nothing, draws no
  /// power and keeps its readings. It stays off until the command is replaced: set_speed, for example,
  /// switches all devices on. Only for controllers with ControllerKind::switches.
  void switch_device(std::size_t chosen, bool on) const {
    command.off = on ? command.off & ~switches[chosen] : command.off | switches[chosen];
  }
  /// Whether a chosen device is on, by the present command.
  bool is_on(std::size_t chosen) const { return (command.off & switches[chosen]) == 0; }

  /// Commands a speed, m/s and rad/s, from the next tick on, until replaced. For a car `turn` is the steering
  /// angle, rad.
  void set_speed(double forward, double left, double turn) {
    command = {forward, left, turn, ControlMode::velocity};
  }
  /// Commands an acceleration, m/s^2 and rad/s^2, until replaced. For a car `turn` is the steering angle,
  /// rad.
  void accelerate(double forward, double left, double turn) {
    command = {forward, left, turn, ControlMode::acceleration};
  }
  /// Commands a goal pose in the frame of Percept::estimate, m and rad. The robot stays there until the
  /// command is replaced.
  void go_to(double x, double y, double heading) { command = {x, y, heading, ControlMode::position}; }

  /// The command of a chosen device whose kind takes commands of this struct.
  template <class DeviceCommand>
  DeviceCommand& device(std::size_t chosen) const {
    return *reinterpret_cast<DeviceCommand*>(devices[chosen]);
  }
};

/// Robots of one type whose controller decides in a tick, with their data. i is an index into `rows`.
struct DecideBatch {
  std::uint64_t tick = 0;                ///< the tick being decided
  double time_s = 0;                     ///< world time at the end of the tick
  double tick_s = 0;                     ///< length of a tick
  std::uint64_t seed = 0;                ///< of the world
  std::uint32_t stream = 0;              ///< of the controller's random numbers
  std::span<const Row> rows;             ///< rows of the batch
  std::span<const BodyId> ids;           ///< id of each row of the world
  std::span<const std::uint32_t> slots;  ///< slot of each row of the world in the tables of its type
  std::span<Command> commands;           ///< drive command of each row of the world
  Estimates estimates;                   ///< estimated poses

  /// Rows of a table, by slot.
  struct Rows {
    std::byte* first = nullptr;  ///< slot 0; null: there is no such table
    std::size_t row_bytes = 0;   ///< stride from one slot to the next

    /// The row of a slot; null if there is no table.
    std::byte* of(std::size_t slot) const { return first == nullptr ? nullptr : first + slot * row_bytes; }
  };
  std::array<const StateTable*, k_most_devices_read> percepts;  ///< state of the chosen devices
  std::array<Rows, k_most_devices_read> device_commands;        ///< their commands
  std::array<std::uint32_t, k_most_devices_read> switches{};    ///< their bits in Command::off
  std::size_t devices = 0;                                      ///< number of chosen devices
  Rows memories;  ///< structs of the kind; none if it has no memory
  /// Commands of the drive device of the controller's part; none: it commands the body's drive, as above.
  Rows drive_commands = {};
  /// State of that drive device: begins with its estimated pose.
  const StateTable* drive_state = nullptr;

  std::size_t size() const { return rows.size(); }  ///< number of robots in the batch
  std::uint32_t body(std::size_t i) const { return ids[rows[i].index()].value; }  ///< id of robot i
  /// Slot of robot i in the tables of its type.
  std::size_t slot(std::size_t i) const { return slots[rows[i].index()]; }
  /// Command of robot i to its drive: that of the controller's part, or else the body's.
  Command& command(std::size_t i) const {
    if (drive_commands.first == nullptr) return commands[rows[i].index()];
    return *reinterpret_cast<Command*>(drive_commands.of(slot(i)));
  }
  /// Estimated pose of robot i: that of the drive of the controller's part, or else that of the body.
  Pose estimate(std::size_t i) const {
    if (drive_state != nullptr) return drive_state->as<Pose>(slot(i));
    return estimates.of(rows[i], slots[rows[i].index()]);
  }
  /// The random numbers of robot i in this tick, at draw 0.
  Random random(std::size_t i) const { return {seed, stream, body(i), static_cast<std::uint32_t>(tick)}; }
  /// Memory of robot i; null if the kind has none.
  std::byte* memory(std::size_t i) const { return memories.of(slot(i)); }
  /// Readings of a device of robot i, by its index among the chosen devices.
  Readings readings(std::size_t sensor, std::size_t i) const { return {*percepts[sensor], slot(i)}; }
  /// Ranges of a ranger of robot i, by the same index: m, one number per beam.
  std::span<const float> ranges(std::size_t sensor, std::size_t i) const {
    return percepts[sensor]->cell<float>(slot(i), 0);
  }
  /// Command of a device of robot i, by the same index; null if its kind takes no commands.
  std::byte* device_command(std::size_t sensor, std::size_t i) const {
    return device_commands[sensor].of(slot(i));
  }
};

/// The exception of a controller that decided for one robot of a batch. ControllerKind::decide may throw this
/// to name the robot. Other exceptions are reported for the whole batch.
struct DecisionError {
  Row row;                    ///< of the robot
  std::exception_ptr thrown;  ///< the controller's exception
};

/// A device of a type, as presented to a controller that chooses its inputs.
struct DeviceInfo {
  std::string_view name;                 ///< DeviceSpec::name
  std::string_view kind;                 ///< DeviceKind::name
  const DeviceKind::Prepared& prepared;  ///< the compiled device
  /// Pose of the device, with its joints at rest, in the frame of the drive that the controller commands.
  Pose pose = {};
};

/// A kind of controller, which computes commands from percepts and memory.
struct ControllerKind {
  std::string_view name;    ///< name in files: "wander"
  std::string_view text;    ///< one sentence for `troupe describe`
  FieldTable params;        ///< its parameters
  bool needs_drive = true;  ///< false: bodies without a drive may have it too
  bool switches = false;    ///< it switches its devices: Actions::switch_device
  /// Fields of the memory struct of each robot. The engine owns its bytes.
  std::vector<StateField> memory;
  std::size_t memory_bytes = 0;  ///< size of that struct; 0: it has no memory
  /// Starts a memory: sets every field, whatever the bytes held (`troupe check --controllers` tries two
  /// fills).
  void (*start)(std::byte* memory);

  /// A controller compiled from its parameters.
  struct Prepared {
    std::any data;  ///< the argument `data` of `decide`
    /// Indices of the devices it uses. It runs when the first one does; without devices, when its drive does.
    std::vector<std::size_t> devices;
  };
  /// Compiles the parameters and chooses devices. `claimed` marks devices that earlier controllers have
  /// claimed; it may claim more. The error says what the type lacks.
  Result<Prepared> (*prepare)(const Record& params, std::span<const DeviceInfo> devices,
                              std::vector<bool>& claimed);
  /// Called once after `prepare`: completes the data from the world, the type and the controller's part, for
  /// example from the pose of a model or from the floor plan. The error says what is wrong. Null: not needed.
  Result<> (*bind_world)(std::any& data, const WorldSpec& world, const TypeSpec& type,
                         std::uint32_t part) = nullptr;
  /// Kinds of devices that a Stage model with this controller carries although its file does not list them.
  std::vector<std::string_view> brings;
  /// Decides for all robots of the batch. make_controller_kind makes it from a function for one robot.
  void (*decide)(const std::any& data, const DecideBatch& batch);
};

/// All kinds that a world can use. Always an argument, never global; assembled in troupe/registry.cpp.
struct Registry {
  std::vector<ModelKind> models;            ///< model kinds of Stage files
  std::vector<DeviceKind> devices;          ///< sensors and other devices
  std::vector<DriveKind> drives;            ///< drives
  std::vector<ControllerKind> controllers;  ///< controllers
  std::vector<MeasureKind> measures;        ///< measures
  std::vector<FaultKind> faults;            ///< faults

  /// A controller with given parameters, under a name of its own (Stage's expand_swarm).
  struct Preset {
    std::string_view name;                                   ///< name in files
    std::string_view kind;                                   ///< of the controller
    std::string_view text;                                   ///< one sentence for `troupe describe`
    std::vector<std::pair<std::string_view, Value>> params;  ///< parameters that differ from the defaults
  };
  std::vector<Preset> presets;  ///< their names differ from those of the controllers

  /// Finds controllers of plug-ins (troupe/plugins.hpp), which are in no list. unknown: the message for an
  /// unknown name; the error is this message, with details. Kinds live as long as the registry and its
  /// copies. Empty: there are no plug-ins.
  std::function<Result<const ControllerKind*>(std::string_view name, std::string unknown)>
      plugged_controllers;
  /// Finds sensors and other devices of plug-ins, in the same way.
  std::function<Result<const DeviceKind*>(std::string_view name, std::string unknown)> plugged_devices;

  /// The kind of this name; null if there is none. Valid as long as the lists are not changed.
  ///@{
  const ModelKind* model(std::string_view name) const;
  const DeviceKind* device(std::string_view name) const;
  const DriveKind* drive(std::string_view name) const;
  const ControllerKind* controller(std::string_view name) const;
  ///@}
  /// The device kind of this name, never null. unknown: the error message if there is none.
  Result<const DeviceKind*> find_device(std::string_view name, std::string unknown) const;
  /// The controller kind of this name, never null; else `unknown controller "hover"; known: expand, ...`.
  Result<const ControllerKind*> find_controller(std::string_view name) const;
  /// Names of the controllers and presets in the lists, sorted.
  std::vector<std::string_view> controller_names() const;
  const Preset* preset(std::string_view name) const;        ///< null if there is none
  const MeasureKind* measure(std::string_view name) const;  ///< null if there is none
  const FaultKind* fault(std::string_view name) const;      ///< null if there is none

  /// The devices that only sense.
  std::vector<DeviceKind> sensors() const;
  std::vector<DeviceKind> other_devices() const;  ///< those that are not in sensors()
};

}  // namespace troupe::engine
