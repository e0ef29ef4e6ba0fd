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
/// A kind turns its parameters once, when the world is built, into whatever it likes to run with
/// (`prepare`), and is then called for batches of rows. Those calls run on several threads at once: they
/// write what they are given and nothing else. An exception ends the step and comes out of World::step().

/// A model kind: what a Stage world file may create. Part of the registry so that loaders share the defaults.
struct ModelKind {
  std::string_view name;                ///< as Stage's files say it: "position"
  std::string_view text;                ///< one sentence for `troupe describe`
  Eigen::Vector3d size{0.4, 0.4, 1.0};  ///< metres, x, y, z, where the file gives none
  Color color{1, 0, 0, 1};              ///< where the file gives none
  bool has_default_body = true;         ///< else one without blocks of its own has no body
  std::string_view device;  ///< kind of the device that each model of this kind is; empty: it is none
  FieldTable params;        ///< of that device, or of the model itself
};

/// Rows of one type whose device senses or acts in a tick, and where all that concerns them lies.
struct DeviceBatch {
  const World& world;          ///< the last committed state
  const std::any& data;        ///< what the kind prepared
  std::span<const Row> rows;   ///< of the batch; all of one type
  StateTable& state;           ///< the device's rows, by slot; of `rows` it may write its own
  const StateTable* commands;  ///< what controllers asked of it, by slot; null where the kind takes none
  Effects& effects;            ///< what it does to others goes here
  Links& links;                ///< where its joints are to go: see move_joint()
  std::uint32_t device = 0;    ///< its index within the type
  std::uint32_t stream = 0;    ///< of its random numbers
  double period_s = 0;         ///< since it last ran

  BodyId body(std::size_t i) const;       ///< whose row it is
  std::size_t slot(std::size_t i) const;  ///< of the row in `state` and `commands`
  /// Its random numbers in this tick.
  Random random(std::size_t i) const;
  /// Others beside them, a sequence for each name: of a kind that makes more of another, so that what it
  /// draws changes nothing of what that draws.
  Random random(std::size_t i, std::string_view name) const;
  /// Where the body's frame is in the world as seen from the device: that of the joint it stands on.
  Mount mount(std::size_t i) const;
  /// Where the n-th joint that the device moves is, relative to its rest.
  const Pose& joint(std::size_t i, std::size_t n) const;
  /// In `act`: where it is to go in this tick. Joints of one device, and of one body with all that it
  /// carries, that are asked in one round go together or not at all.
  void move_joint(std::size_t i, std::size_t n, const Pose& to) const;
  /// In `settled`: whether it was asked to move, and whether it did.
  bool asked_joint(std::size_t i, std::size_t n) const;
  /// In `settled`: whether it moved.
  bool moved_joint(std::size_t i, std::size_t n) const;
  /// Has an effect applied once all have moved: DeviceKind::apply. Throws std::length_error where a row emits
  /// more than `Prepared::most_effects` of them. sequence: orders those of one row in a tick; verb, payload:
  /// matters of the kind; target: may be not valid
  void emit(std::size_t i, std::uint32_t sequence, std::uint32_t verb, BodyId target,
            const std::array<double, 4>& payload = {}) const {
    effects.emit({body(i), device, sequence, verb, target, payload});
  }
  /// Asks that the next body of a reserve be born at a pose, m and rad, world frame; DeviceKind::born tells
  /// what became of it.
  void emit_birth(std::size_t i, std::uint32_t sequence, std::uint32_t reserve, const Pose& at) const {
    effects.emit({body(i), device, sequence, k_birth, BodyId(), {at.x, at.y, at.z, at.heading}, reserve});
  }
  /// Asks that a body die: its kind, or its parameters, must say that it does (Prepared::ends_lives).
  void emit_death(std::size_t i, std::uint32_t sequence, BodyId whose) const {
    effects.emit({body(i), device, sequence, k_death, whose});
  }
};

/// A fan of beams of a ranging sensor, which leave from one place.
struct Transducer {
  std::size_t first = 0;        ///< of its readings among the sensor's
  std::size_t samples = 1;      ///< how many of them are its
  Pose pose_sensor_transducer;  ///< where the beams start, and their middle's heading; sensor's frame
  double range_max = 0;         ///< m
  double fov = 0;               ///< between the first beam and the last, rad; of a single one: how wide it is
};

/// The pictures that a camera makes: which of its percepts they are.
struct Camera {
  std::size_t width = 0;   ///< pixels
  std::size_t height = 0;  ///< pixels
  double range_far = 0;    ///< m: the depth of a pixel that shows nothing
  std::size_t color = 0;   ///< percept: u8 [red green blue opacity] each, row by row from the upper left
  std::size_t depth = 1;   ///< percept: f32 each, m along the axis of view
};

/// The marked parts (Returns::fiducial) that a sensor finds.
struct SoughtMarks {
  std::int32_t key = 0;       ///< Returns::fiducial_key of what it finds
  bool at_any_height = true;  ///< else only what its own height meets
};

/// Flags that a device holds.
struct HeldFlags {
  std::size_t count = 0;       ///< that it holds
  std::uint64_t received = 0;  ///< that others gave it since tick 0
};

/// The device of one row, for who makes a picture of it.
struct DeviceView {
  const World& world;       ///< the last committed state
  const std::any& data;     ///< what the kind prepared
  const StateTable& state;  ///< the device's rows, by slot
  std::size_t slot = 0;     ///< of the row in `state`
  std::uint32_t body = 0;   ///< index into Frame::mobile
  Pose pose_world_device;   ///< where joints have carried it

  /// A point of the device's frame, m, in the world's.
  Eigen::Vector3d at(double x, double y, double z) const;
};

/// The layer of pictures that shows what devices of a kind do.
enum class FrameLayer : std::uint8_t {
  none,    ///< they are not shown
  sights,  ///< Frame::sights
  blobs,   ///< Frame::blobs
  grips,   ///< Frame::grips
};

/// What a body carries that has a state of its own: sensors, which look at the world, and other devices
/// (grippers, lights, power packs), which take commands and act on it.
struct DeviceKind {
  std::string_view name;  ///< as files say it: "ranger"
  std::string_view text;  ///< one sentence for `troupe describe`
  FieldTable params;      ///< its parameters
  /// Names of the joints that it moves; a single one needs none.
  std::vector<std::string_view> joints;
  /// Whether it can pick up other bodies.
  bool carries = false;
  /// Whether it is a drive: what controllers of its part, and of those that stand on that, ask of theirs.
  /// Its commands are a Command (command_fields), and its state begins with the pose that it believes to
  /// have.
  bool drives = false;
  /// A solid that a device brings along, where it is with its joints at rest.
  struct Fixture {
    Solid solid;              ///< in the device's own frame
    std::int32_t joint = -1;  ///< of its own, that the solid moves with
  };
  /// What it brings along. Null: nothing.
  std::vector<Fixture> (*body)(const Record& params) = nullptr;
  /// Parameters -> what `sense` needs; also says what state a row has.
  struct Prepared {
    std::any data;                     ///< what `sense` and the others are given as `data`
    std::vector<StateField> percepts;  ///< element fields of the sensor's state table
    std::size_t percept_bytes = 0;     ///< of a struct that the percepts are (memory_fields); 0: of none
    std::vector<StateField> commands;  ///< what controllers may ask of it: fields of a struct (memory_fields)
    std::size_t command_bytes = 0;     ///< of that struct; 0: it takes no commands
    double reach_m = 0;                ///< radius of the declared query about the body's origin
    std::size_t beams = 0;             ///< rays cast each time it runs
    std::size_t most_effects = 0;      ///< that a row may emit in a tick
    bool ends_lives = false;           ///< some of them may be deaths
    double watts = 0;                  ///< drawn from its supply while it runs
    std::vector<Pose> joints;          ///< where its joints are at tick 0; none given: at rest
    double joint_reach_m = 0;          ///< they go no farther from their rest, as far as is known
    /// Heading of each reading in the sensor's frame, rad; empty for sensors that are no rangers, as are
    /// `transducers`. The ranges are their percept 0.
    std::vector<double> bearings;
    std::vector<Transducer> transducers;  ///< in the order of the readings: together they have all of them
    std::optional<Camera> camera;         ///< of a sensor whose readings are pictures
    std::optional<SoughtMarks> seeks;     ///< of a sensor that finds marked parts
  };
  /// Pure. Throws nothing of its own: parameters are within the bounds of their table.
  Prepared (*prepare)(const Record& params, const Pose& pose_body_sensor);
  /// Once behind `prepare`, where more is to be known of what carries it: completes the data from the type
  /// and its part, or says what is wrong with them. Null: it needs nothing.
  Result<> (*mount)(std::any& data, const TypeSpec& type, std::uint32_t part) = nullptr;
  /// Once behind `mount`, where it must know the world: completes the data, or says what is wrong. Null: it
  /// need not know.
  Result<> (*look)(std::any& data, const WorldSpec& world) = nullptr;
  /// Sets the state of a row as its life begins, at tick 0 or later; all bytes are 0. Null: that is right.
  void (*start)(const std::any& data, StateTable& state, std::size_t slot) = nullptr;
  /// In the sense phase: writes the percepts of every row it is given (all of one type); reads S(k) only.
  /// Returns the rays it cast. Null: it senses nothing.
  std::uint64_t (*sense)(const DeviceBatch& batch) = nullptr;
  /// Before the controllers decide, as drives do: carries out the commands of the tick before. Null: it does
  /// nothing.
  void (*act)(const DeviceBatch& batch) = nullptr;
  /// When bodies and joints have moved, for all rows of which some were asked to move a joint: learns what
  /// became of its own.
  void (*settled)(const DeviceBatch& batch) = nullptr;
  /// Where the bodies have moved: what one effect of this kind does. Effects come one after another, by
  /// (source, device, sequence), each seeing what the earlier ones did. Null: it has none.
  void (*apply)(World& world, const std::any& data, const Effect& effect) = nullptr;
  /// Behind all other effects of the tick: what became of a birth that its row asked for. Null: it asks for
  /// none, or does not want to know.
  void (*born)(World& world, const std::any& data, const Effect& effect, const Birth& birth) = nullptr;

  /// Of a kind that supplies others, as a power pack does: whether a row has nothing left, so that what runs
  /// on it stops. The part that carries it runs on it and what stands on that, down to parts with a supply of
  /// their own; so does the drive, where the root carries it. Null: it supplies no other device.
  bool (*is_spent)(const std::any& data, const StateTable& state, std::size_t slot) = nullptr;

  bool needs_supply = false;  ///< it is of no use where nothing supplies it
  /// What a row stores. Null: it stores no energy.
  Energy (*energy)(const StateTable& state, std::size_t slot) = nullptr;
  /// What a row holds. Null: it holds no flags.
  HeldFlags (*flags)(const StateTable& state, std::size_t slot) = nullptr;

  /// Its state begins with the colour that its part shows: three f32, red, green and blue, called
  /// k_shown_color (engine/shown_color.hpp), by which recordings find it.
  bool shows_color = false;
  FrameLayer layer = FrameLayer::none;  ///< in which `show` shows its rows
  /// Adds to `layer` what pictures show of a row. Sensors are asked where they have looked and run. Null
  /// where there is no layer.
  void (*show)(const DeviceView& view, Frame& frame) = nullptr;

  /// True where it does nothing but look: what people call a sensor.
  bool is_sensor() const { return act == nullptr && apply == nullptr && born == nullptr; }
};

/// What the numbers of a command are.
enum class ControlMode : std::uint8_t {
  velocity,      ///< speeds, m/s and rad/s; for a `car` turn is the steering angle, rad
  acceleration,  ///< m/s^2 and rad/s^2; for a `car` turn is the steering angle, rad
  position,      ///< a goal in the frame of the estimate, m and rad
};
inline constexpr std::size_t k_control_modes = 3;  ///< values of ControlMode

/// What a controller asks of its drive, in the body's frame (a goal: in the estimate's): forward, left,
/// counter-clockwise. To assign `{x, y, turn}` commands a speed; to change one number keeps the mode.
struct Command {
  double x = 0;                              ///< forward
  double y = 0;                              ///< left
  double turn = 0;                           ///< counter-clockwise
  ControlMode mode = ControlMode::velocity;  ///< what the numbers are
  std::uint32_t off = 0;  ///< devices that its controller has switched off: BodyType::Device::switch_bit
};

/// Its members, for tables.
std::vector<StateField> command_fields();

/// How a body moves by its drive.
struct Velocity {
  double x = 0;     ///< m/s, body frame, forward
  double y = 0;     ///< m/s, body frame, left
  double turn = 0;  ///< rad/s
};

/// Drives of robots of one type that are due in a tick; sizes are equal.
struct DriveBatch {
  std::span<const Command> commands;  ///< one a robot
  std::span<Velocity> velocities;     ///< in: of the last tick, where `estimates` are given; out: of this one
  std::span<const Pose> estimates;    ///< empty where all commands are speeds
  double elapsed_s = 0;               ///< since they were due before
};

/// A way to move: from commands to velocities.
struct DriveKind {
  std::string_view name;  ///< as files say it: "diff"
  std::string_view text;  ///< one sentence for `troupe describe`
  FieldTable params;      ///< its parameters
  /// Parameters -> what the others are given as `data`.
  std::any (*prepare)(const Record& params);
  /// Whether the parameters fit together; else what is wrong with them.
  Result<> (*check)(const Record& params);
  /// Velocities of a batch from their commands, bounds applied.
  void (*drive)(const std::any& data, const DriveBatch& batch);
  /// With which a robot moves until its drive is due for the first time. Null: it stands.
  Velocity (*start)(const std::any& data) = nullptr;
  /// What of its parameters the engine carries out itself.
  ///@{
  /// How its robots know where they are, or why the parameters do not fit together. Null: they know their
  /// true poses.
  Result<Localization> (*localization)(const Record& params) = nullptr;
  /// How many pushable bodies it pushes at once, 0 to k_most_pushed. Null: it pushes none.
  std::int64_t (*pushes)(const Record& params) = nullptr;
  ///@}
};

/// Sensors and other devices that one controller can use.
inline constexpr std::size_t k_most_devices_read = 16;

/// The state of one sensor, or other device, of one robot.
class Readings {
 public:
  Readings() = default;
  /// A row of a device's table; both live as long as the decision.
  Readings(const StateTable& table, std::size_t slot) : table_(&table), slot_(slot) {}
  /// A field, by its place among the kind's percepts; one value a column.
  template <class T>
  std::span<const T> field(std::size_t f) const {
    return table_->cell<T>(slot_, f);
  }
  /// All of it, where the kind's percepts are the members of a struct.
  template <class State>
  const State& as() const {
    return table_->as<State>(slot_);
  }

 private:
  const StateTable* table_ = nullptr;
  std::size_t slot_ = 0;
};

/// What one robot's controller sees in a tick.
struct Percept {
  std::uint64_t tick = 0;  ///< the tick being decided; 1 is the first
  double time_s = 0;       ///< world time at its end
  double tick_s = 0;       ///< length of a tick, s
  std::uint32_t body = 0;  ///< id of its own body
  /// The sensors and other devices it asked for in `prepare`, in that order.
  std::span<const Readings> devices;
  /// Its estimated pose: engine/localization.hpp.
  Pose estimate;

  /// Of a ranger, m.
  std::span<const float> ranges(std::size_t ranger) const { return devices[ranger].field<float>(0); }
};

/// What it may do: slots of its own body, already holding the last values.
struct Actions {
  Command& command;  ///< of its drive, holding what was asked last
  /// What it asks of the devices it chose, in the order of Percept::devices; null for those that take no
  /// commands.
  std::span<std::byte* const> devices;
  /// Beside them: the bits of Command::off.
  std::span<const std::uint32_t> switches;

  /// Switches a device that it chose on or off, from the next tick on: one that is off does nothing, draws
  /// nothing and keeps its readings. It stays off as long as the command holds: another command, as set_speed
  /// gives one, switches all on. Of kinds of controllers that say so (ControllerKind::switches).
  void switch_device(std::size_t chosen, bool on) const {
    command.off = on ? command.off & ~switches[chosen] : command.off | switches[chosen];
  }
  /// As its last command has it.
  bool is_on(std::size_t chosen) const { return (command.off & switches[chosen]) == 0; }

  /// m/s and rad/s, from the next tick on, until replaced; for a car `turn` is the steering angle.
  void set_speed(double forward, double left, double turn) {
    command = {forward, left, turn, ControlMode::velocity};
  }
  /// m/s^2 and rad/s^2: speeds change by as much a second until replaced; of a car `turn` is the steering
  /// angle.
  void accelerate(double forward, double left, double turn) {
    command = {forward, left, turn, ControlMode::acceleration};
  }
  /// To a pose in the frame of Percept::estimate, m and rad; it stays there until it is told otherwise.
  void go_to(double x, double y, double heading) { command = {x, y, heading, ControlMode::position}; }

  /// Of a device whose kind takes commands of this struct.
  template <class DeviceCommand>
  DeviceCommand& device(std::size_t chosen) const {
    return *reinterpret_cast<DeviceCommand*>(devices[chosen]);
  }
};

/// Robots of one type whose controller decides in a tick: where all that concerns robot i of the batch lies.
struct DecideBatch {
  std::uint64_t tick = 0;                ///< the tick being decided
  double time_s = 0;                     ///< world time at its end
  double tick_s = 0;                     ///< length of a tick
  std::uint64_t seed = 0;                ///< the world's
  std::uint32_t stream = 0;              ///< of the controller's random numbers
  std::span<const Row> rows;             ///< of the batch
  std::span<const BodyId> ids;           ///< a row each, as are:
  std::span<const std::uint32_t> slots;  ///< of each row: where it lies in the tables of its type
  std::span<Command> commands;           ///< of each row: what is asked of its body's drive
  Estimates estimates;                   ///< estimated poses

  /// A row of a table each slot.
  struct Rows {
    std::byte* first = nullptr;  ///< slot 0; null: there is no such table
    std::size_t row_bytes = 0;   ///< from one slot to the next

    /// Null where there is no table.
    std::byte* of(std::size_t slot) const { return first == nullptr ? nullptr : first + slot * row_bytes; }
  };
  std::array<const StateTable*, k_most_devices_read> percepts;  ///< of the sensors it chose, and
  std::array<Rows, k_most_devices_read> device_commands;        ///< what may be asked of them
  std::array<std::uint32_t, k_most_devices_read> switches{};    ///< and their bits in Command::off
  std::size_t devices = 0;                                      ///< how many it chose
  Rows memories;  ///< of the kind's struct; none where it has no memory
  /// Of the drive that the controller's part has for itself; none: it commands the body's, as above.
  Rows drive_commands = {};
  /// Of that drive: begins with the pose that it believes to have.
  const StateTable* drive_state = nullptr;

  std::size_t size() const { return rows.size(); }  ///< robots in the batch; i, below, is one of them
  std::uint32_t body(std::size_t i) const { return ids[rows[i].index()].value; }  ///< id of robot i
  /// Its place in the tables of its type.
  std::size_t slot(std::size_t i) const { return slots[rows[i].index()]; }
  /// What robot i asks of its drive: that of the controller's part, or else the body's.
  Command& command(std::size_t i) const {
    if (drive_commands.first == nullptr) return commands[rows[i].index()];
    return *reinterpret_cast<Command*>(drive_commands.of(slot(i)));
  }
  /// Estimated pose of robot i: that of its drive on a joint where it has one, or else that of the body.
  Pose estimate(std::size_t i) const {
    if (drive_state != nullptr) return drive_state->as<Pose>(slot(i));
    return estimates.of(rows[i], slots[rows[i].index()]);
  }
  /// The random numbers of robot i in this tick, at draw 0.
  Random random(std::size_t i) const { return {seed, stream, body(i), static_cast<std::uint32_t>(tick)}; }
  /// Of robot i; null where it has none.
  std::byte* memory(std::size_t i) const { return memories.of(slot(i)); }
  /// Of a device of robot i, by its place among those that the controller chose.
  Readings readings(std::size_t sensor, std::size_t i) const { return {*percepts[sensor], slot(i)}; }
  /// Of a ranger of robot i, likewise: m, a number a beam.
  std::span<const float> ranges(std::size_t sensor, std::size_t i) const {
    return percepts[sensor]->cell<float>(slot(i), 0);
  }
  /// What is asked of a device of robot i, likewise; null where its kind takes no commands.
  std::byte* device_command(std::size_t sensor, std::size_t i) const {
    return device_commands[sensor].of(slot(i));
  }
};

/// What a controller threw when it decided for one robot of a batch: ControllerKind::decide may throw this,
/// so that the robot can be named. Anything else that it throws is said of the batch.
struct DecisionError {
  Row row;                    ///< of the robot
  std::exception_ptr thrown;  ///< what the controller threw
};

/// A sensor of a type, as a controller that looks for its inputs sees it.
struct DeviceInfo {
  std::string_view name;                 ///< DeviceSpec::name
  std::string_view kind;                 ///< DeviceKind::name
  const DeviceKind::Prepared& prepared;  ///< what its kind made of its parameters
  /// Of the device, with its joints at rest, in the frame of the drive that the controller commands.
  Pose pose = {};
};

/// A way to decide: from percepts and memory to commands.
struct ControllerKind {
  std::string_view name;    ///< as files say it: "wander"
  std::string_view text;    ///< one sentence for `troupe describe`
  FieldTable params;        ///< its parameters
  bool needs_drive = true;  ///< else also bodies that cannot move may have it
  bool switches = false;    ///< it switches its devices: Actions::switch_device
  /// Fields of the per-robot memory; the struct's bytes are owned by the engine.
  std::vector<StateField> memory;
  std::size_t memory_bytes = 0;  ///< of that struct; 0: it has no memory
  /// Starts a memory: sets every field, whatever the bytes held (`troupe check --controllers` tries two
  /// fills).
  void (*start)(std::byte* memory);

  /// What `prepare` makes of the parameters.
  struct Prepared {
    std::any data;  ///< what `decide` is given
    /// Indices of the devices it uses; the first is its trigger. None: it runs with its drive.
    std::vector<std::size_t> devices;
  };
  /// Chooses among the devices of the type those that no controller before it has `claimed`, and marks its
  /// own; or says what the type lacks that the controller needs.
  Result<Prepared> (*prepare)(const Record& params, std::span<const DeviceInfo> devices,
                              std::vector<bool>& claimed);
  /// Once behind `prepare`, where it must know the world: where a model stands, what the floor plan is, what
  /// its own part looks like. Completes the data, or says what is wrong. Null: it need not know.
  Result<> (*look)(std::any& data, const WorldSpec& world, const TypeSpec& type,
                   std::uint32_t part) = nullptr;
  /// Kinds of devices that a Stage model with this controller carries, though its file cannot say so.
  std::vector<std::string_view> brings;
  /// For all robots of the batch. make_controller_kind makes it from what decides for one.
  void (*decide)(const std::any& data, const DecideBatch& batch);
};

/// Everything a world can be made of. Passed in, never global; assembled in troupe/registry.cpp.
struct Registry {
  std::vector<ModelKind> models;            ///< what Stage's files may create
  std::vector<DeviceKind> devices;          ///< sensors and other devices
  std::vector<DriveKind> drives;            ///< ways to move
  std::vector<ControllerKind> controllers;  ///< ways to decide
  std::vector<MeasureKind> measures;        ///< what can be measured
  std::vector<FaultKind> faults;            ///< how robots may fail

  /// A controller with its parameters already chosen, under a name of its own (Stage's expand_swarm).
  struct Preset {
    std::string_view name;                                   ///< as files say it
    std::string_view kind;                                   ///< of the controller
    std::string_view text;                                   ///< one sentence for `troupe describe`
    std::vector<std::pair<std::string_view, Value>> params;  ///< those that are not the defaults
  };
  std::vector<Preset> presets;  ///< apart from the controllers' names

  /// Controllers that stand in no list, nor among the presets: those of plug-ins (troupe/plugins.hpp). An
  /// error where there is none of this name: `unknown`, which is what is said of an unknown name, and what
  /// more is known of it. Kinds live as long as the registry and its copies. Empty: there are no others.
  std::function<Result<const ControllerKind*>(std::string_view name, std::string unknown)>
      plugged_controllers;
  /// The same of sensors and other devices.
  std::function<Result<const DeviceKind*>(std::string_view name, std::string unknown)> plugged_devices;

  /// The kind of this name; null where there is none. Valid as long as the lists are not changed.
  ///@{
  const ModelKind* model(std::string_view name) const;
  const DeviceKind* device(std::string_view name) const;
  const DriveKind* drive(std::string_view name) const;
  const ControllerKind* controller(std::string_view name) const;
  ///@}
  /// The same, never null; where there is none, why. unknown: what is said of an unknown name.
  Result<const DeviceKind*> find_device(std::string_view name, std::string unknown) const;
  /// The same: `unknown controller "hover"; known: expand, ...`.
  Result<const ControllerKind*> find_controller(std::string_view name) const;
  /// Names of the controllers and presets that stand in the lists, sorted.
  std::vector<std::string_view> controller_names() const;
  const Preset* preset(std::string_view name) const;        ///< null where there is none
  const MeasureKind* measure(std::string_view name) const;  ///< null where there is none
  const FaultKind* fault(std::string_view name) const;      ///< null where there is none

  /// The devices that only look, and those that do more.
  std::vector<DeviceKind> sensors() const;
  std::vector<DeviceKind> other_devices() const;  ///< those that sensors() leaves out
};

}  // namespace troupe::engine
