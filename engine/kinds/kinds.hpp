#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/kinds/energy.hpp"
#include "engine/kinds/fault_kind.hpp"
#include "engine/kinds/localization.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/kinds/mount.hpp"

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

class Collision;
class CommittedView;
class Links;
class SensingView;
class World;
struct Command;
struct Frame;
struct Velocity;
struct Registry;
struct TypeSpec;
struct WorldSpec;

/// The kinds of devices, drives and controllers, and the data that the engine passes to them.
///
/// A *body* is a robot or another object of the world. A *static* body is fixed for the whole run. All bodies
/// of a *type* have the same rigid parts, joints, devices, drive and controllers. A *device* is equipment on
/// a part of a body. It is either a *sensor*, which only reads the world, or another device, such as a
/// gripper or a battery. The state of a device is also called its *percepts* or readings. A *drive* moves the
/// whole body. A *drive device* is a device that moves one part of the body in the same way
/// (DeviceKind::drives). A *reserve* is a list of bodies that are not yet in the world and can be born later.
///
/// The state of the world is stored in tables. A body that is not static has a *row*, its index in the state
/// tables of the world. It also has a *slot*, its index in the state tables of its type. A *batch* is a list
/// of rows for which the engine calls a function. Several *ranks* (threads or processes) can compute one
/// world together. Each rank then has the rows of some bodies.
///
/// Time advances in *ticks*, steps of equal length. Tick 0 is the initial state. A tick has several phases.
/// In the phase `sense` the sensors read the state at the end of the last tick. In `actuate` the drives
/// compute velocities and the other devices act. In `decide` the controllers compute commands, which take
/// effect in the next tick. Then the bodies move. A device, drive or controller is *due* once per period. It
/// runs in the ticks in which it is due, unless it is stopped, for example by a fault.
///
/// A *kind* is a table of functions, called *hooks*, that implements one sort of device, drive or controller.
/// When the world is built, the hook `prepare` converts the parameters to data of a type that the kind
/// chooses. Most other hooks receive these data, together with a batch or a single body. Several threads call
/// the hooks at once, so a hook may write only to its arguments. If a hook throws an exception during a step,
/// World::step() throws a StepError. If DeviceKind::draw, energy or flags throws between two steps, the
/// caller gets a std::runtime_error that names the device and the robot. Only the hook DeviceKind::is_spent
/// must not throw.

/// A model type of world files of the simulator Stage, such as `position` or `ranger`, with its defaults. All
/// loaders of world files use the model kinds in the list Registry::models, and therefore the same defaults.
struct ModelKind {
  std::string_view name;                ///< name in Stage files: "position"
  std::string_view text;                ///< description in one sentence, which `troupe describe` prints
  Eigen::Vector3d size{0.4, 0.4, 1.0};  ///< default size x, y, z, m
  Color color{1, 0, 0, 1};              ///< default colour
  /// Default shape of a model. True: a box of the model's size. False: no solids. A file can give a model
  /// another shape, by blocks (extruded polygons) or by a bitmap (an image of walls).
  bool has_default_body = true;
  std::string_view device;  ///< DeviceKind::name of the device that such a model adds; empty: none
  /// Table of the parameters of the device kind `device`. If `device` is empty: table of the parameters of
  /// the model itself.
  FieldTable params;
};

/// Throws std::out_of_range with a message for the author of a controller or device: it used the robot with
/// the index `index` of a batch of `count` robots (DeviceBatch, DecideBatch).
[[noreturn]] void throw_no_robot(std::size_t index, std::size_t count);

/// The argument of the hooks `sense`, `act` and `joints_moved` of a device kind: rows (bodies) of one type
/// for which the hook is called in a tick, with the data of these rows. There is at least one row. The
/// argument `i` of the functions is an index into `rows`. The class of `view`, by which a hook reads the
/// world, is declared in engine/sensing/sensing_view.hpp.
struct DeviceBatch {
  const SensingView& view;     ///< gives access to constants of the world and to the places of all bodies
  const std::any& data;        ///< the compiled parameters of the device (DeviceKind::Prepared::data)
  std::span<const Row> rows;   ///< rows of the batch; all of one type
  StateTable& state;           ///< state of the device, by slot; hooks may write only to the slots of `rows`
  const StateTable* commands;  ///< commands from controllers, by slot; null if the kind takes none
  Effects& effects;            ///< receives the effects of the device: see emit()
  Links& links;                ///< receives the poses to which joints shall move: see move_joint()
  std::uint32_t device = 0;    ///< index of the device within the type
  std::uint32_t stream = 0;    ///< number of the device's random stream: see random()
  /// Period of the device, rounded up to whole ticks, s. The time from one run of the device to the next is
  /// equal to this period, or longer if the device was switched off, broken or without power in between.
  double period_s = 0;

  /// Row i of the batch. Throws std::out_of_range if i is not below the number of rows, as all functions
  /// below do that have an argument `i`.
  Row row(std::size_t i) const {
    if (i >= rows.size()) throw_no_robot(i, rows.size());
    return rows[i];
  }
  BodyId body(std::size_t i) const;       ///< id of the row's body
  std::size_t slot(std::size_t i) const;  ///< index of the row in `state` and `commands`
  /// The random numbers of a row in this tick: a function of the seed of the world, `stream`, the id of the
  /// body and the tick. Each call returns the same sequence from its beginning.
  Random random(std::size_t i) const;
  /// The random numbers of a row in this tick, from a stream that `name` selects. They are independent of the
  /// numbers of random(i). For example, a kind that adds noise to the readings of another kind draws from a
  /// stream of its own: the other kind then gets the same random numbers as without the noise.
  Random random(std::size_t i, std::string_view name) const;
  /// Transform that gives the present pose of the device of row i in the world frame: compose(mount(i), p).
  /// Here, p is the argument `pose_body_device` of DeviceKind::prepare: the pose of the device in the body
  /// frame, with all joints at rest. For a device on no joint, the transform is the pose of the body. For a
  /// device on a joint, it also contains the present displacement of the joint from rest.
  Mount mount(std::size_t i) const;
  /// Velocity that the drive of the row's body computed last, body frame, m/s and rad/s. If a fault slows
  /// down the drive, this is the reduced velocity. It is 0 if the body has no drive or the drive has no
  /// power. The drives run before the hook `act`: if the drive is due in this tick, `act` gets the new
  /// velocity.
  const Velocity& velocity(std::size_t i) const;
  /// Command to the drive of the row's body. The numbers have no meaning if the body has no drive.
  const Command& command(std::size_t i) const;
  /// Whether a device of the row's body is in use. A device is in use if a controller uses it, if the world
  /// file makes it active (BodyType::Device::active), or if a program called World::subscribe() for the body.
  /// Here and below, `its_device` is the index of the device in BodyType::devices; std::out_of_range is
  /// thrown if there is no such device.
  bool senses(std::size_t i, std::size_t its_device) const;
  /// Whether a device of the row's body is switched on. A device is on unless a controller has switched it
  /// off.
  bool is_on(std::size_t i, std::size_t its_device) const;
  /// Whether a device of the row's body runs in the ticks in which it is due (once per period). The device
  /// runs if senses() and is_on() are true, no fault has broken it, it has power, and its body is neither
  /// disabled nor stopped by a fault.
  bool runs(std::size_t i, std::size_t its_device) const;
  /// State table of the device `its_device` of the bodies of this type. The state of row i of the batch is in
  /// row slot(i) of the table. A hook may read only the states of rows of the batch.
  const StateTable& percepts(std::size_t its_device) const;
  /// Present pose of joint n relative to its rest pose, m and rad. Here and below, joint n is the joint with
  /// the index n in DeviceKind::joints. The four functions throw StepError if the kind has no joint n.
  const Pose& joint(std::size_t i, std::size_t n) const;
  /// Sets the goal of joint n for this tick: a pose relative to the rest pose of the joint, m and rad. The
  /// heading is not wrapped. A second call in the same tick replaces the goal. Only the hook `act` may call
  /// this. Throws StepError if a number of `to` is not finite.
  ///
  /// After the bodies have moved, the joints of the device move to their goals together. If an obstacle
  /// blocks one of these joints, none of them moves. A blocked motion can also stop joints of bodies that
  /// this body carries, or of bodies that carry it: see Links::resolve_joints().
  void move_joint(std::size_t i, std::size_t n, const Pose& to) const;
  /// Whether the hook `act` set a goal of joint n with move_joint() in this tick. Only the hook
  /// `joints_moved` may call this.
  bool asked_joint(std::size_t i, std::size_t n) const;
  /// Whether joint n is at its goal of this tick. The result is also true if the joint already was at the
  /// goal. It is false if the joint has no goal. Only the hook `joints_moved` may call this.
  bool moved_joint(std::size_t i, std::size_t n) const;
  /// Emits an effect of row i: a record of an action of the device on a body. After all bodies have moved,
  /// the hook DeviceKind::apply applies the effect. Only the hook `act` may call this. Throws
  /// std::length_error if all devices of the world together emit more effects in a tick than their kinds
  /// declare (DeviceKind::Prepared::most_effects). World::step() throws a StepError if there is no body with
  /// the id `target`, or if the kind has no hook `apply`.
  ///
  /// sequence: number that orders the effects of the device of one body in a tick; each of these effects must
  /// have a different number
  /// verb, payload: the kind defines their meaning; the verb must be neither k_birth nor k_death
  /// target: the affected body; not valid() if there is none. It may be a static body, which has no row
  void emit(std::size_t i, std::uint32_t sequence, std::uint32_t verb, BodyId target,
            const std::array<double, 4>& payload = {}) const {
    effects.emit({body(i), device, sequence, verb, target, payload});
  }
  /// Requests the birth of the next body of a reserve. Only the hook `act` may call this. The birth comes
  /// after all other effects and all deaths of the tick. Then the hook DeviceKind::born receives the result,
  /// which says whether a body was born. If the body of row i dies in this tick, there is no birth, and
  /// `born` is not called.
  ///
  /// The request counts as an effect: std::length_error is thrown as in emit(). World::step() throws a
  /// StepError if the reserve does not exist.
  ///
  /// sequence: as in emit(); each effect of the device of one body in a tick must have a different number
  /// reserve: index into WorldSpec::reserves; must exist
  /// at: pose at birth, world frame, m and rad
  void emit_birth(std::size_t i, std::uint32_t sequence, std::uint32_t reserve, const Pose& at) const {
    effects.emit({body(i), device, sequence, k_birth, BodyId(), {at.x, at.y, at.z, at.heading}, reserve});
  }
  /// Requests the death of the body `whose`. Only the hook `act` may call this. The hook `prepare` of the
  /// kind must have set DeviceKind::Prepared::ends_lives. Nothing happens if the body is static or is not in
  /// the world. The request counts as an effect: std::length_error is thrown as in emit().
  ///
  /// sequence: as in emit(); each effect of the device of one body in a tick must have a different number
  void emit_death(std::size_t i, std::uint32_t sequence, BodyId whose) const {
    effects.emit({body(i), device, sequence, k_death, whose});
  }
};

/// The argument of the hook `sense`. In addition to the data of a DeviceBatch, it gives access to the
/// velocities, commands and device states of all bodies at the end of the last tick, except the states of
/// sensors, which other threads are writing. If a class C does not read these additional data, it may declare
/// `sense(const DeviceBatch&)`: make_device_kind() accepts both.
struct SenseBatch : DeviceBatch {
  /// View of the same world as `view`. It also gives access to the velocities, commands and device states of
  /// all bodies. The states of sensors must not be read.
  const CommittedView& committed;
};

/// A fan of beams of a ranging sensor that start at one place.
struct Transducer {
  std::size_t first = 0;        ///< index of its first reading among the readings of the sensor
  std::size_t samples = 1;      ///< number of its readings
  Pose pose_sensor_transducer;  ///< origin of the beams and heading of their middle; sensor frame
  double range_max = 0;         ///< length of the beams, m
  double fov = 0;  ///< angle from the first beam to the last, rad; with a single beam, the width of that beam
};

/// The images of a camera: their size, and the fields of the camera's state that hold them, as indices into
/// DeviceKind::Prepared::percepts.
struct Camera {
  std::size_t width = 0;   ///< width of the images, pixels
  std::size_t height = 0;  ///< height of the images, pixels
  double range_far = 0;    ///< largest visible depth, m; also the depth of a pixel that shows no surface
  /// Index of the field with the colours: per pixel four values of type u8 (red, green, blue, opacity), row
  /// by row from the upper left.
  std::size_t color = 0;
  /// Index of the field with the depths: per pixel one f32, m along the optical axis.
  std::size_t depth = 1;
};

/// Specifies which parts of bodies a fiducial finder (a sensor of markers) detects. A part is marked if its
/// value Returns::fiducial is not 0.
struct SoughtMarks {
  std::int32_t key = 0;       ///< the sensor detects only marked parts with this Returns::fiducial_key
  bool at_any_height = true;  ///< false: only parts whose height interval contains the height of the sensor
};

/// The flags that a device holds. A flag is a coloured token that bodies hold and exchange, as in Stage.
struct HeldFlags {
  std::size_t count = 0;       ///< number of flags that the device holds now
  std::uint64_t received = 0;  ///< number received from other bodies since the device came into the world
};

/// The argument of the hook DeviceKind::draw, which draws the device of one body. The hook adds its drawings
/// to a Frame, the picture of the world at one tick.
struct DeviceView {
  const World& world;       ///< the world, between two ticks
  const std::any& data;     ///< the compiled parameters of the device (DeviceKind::Prepared::data)
  const StateTable& state;  ///< state of the device, by slot
  std::size_t slot = 0;     ///< slot of the body: index of its row in `state`
  std::uint32_t body = 0;   ///< index of the body in Frame::mobile, the list of bodies
  Pose pose_world_device;   ///< present pose, world frame, m and rad; includes the displacement of joints

  /// Converts a point from the device frame to the world frame, m.
  Eigen::Vector3d at(double x, double y, double z) const;
};

/// The list to which the devices of a kind add their drawings (DeviceKind::draw). The list is a member of
/// Frame, the picture of the world at one tick.
enum class FrameLayer : std::uint8_t {
  none,    ///< not drawn
  sights,  ///< detections: Frame::sights
  blobs,   ///< blobs of colour: Frame::blobs
  grips,   ///< gripper beams and held bodies: Frame::grips
};

/// The bodies that an effect (an action of a device on another body) may change when it is applied.
enum class ApplyScope : std::uint8_t {
  trees,       ///< the body of the device, the target, and all bodies that move together with either of them;
               ///< the target must be within the reach of the device (DeviceKind::Prepared::reach_m)
  any_target,  ///< the bodies of `trees`, but the target may be anywhere in the world
  anything,    ///< any body
};

// Names for DeviceKind::reads, which lists the data that a device reads of other bodies.
inline constexpr std::string_view k_velocity_of_others = "velocity";  ///< velocities that drives computed
inline constexpr std::string_view k_command_of_others = "command";    ///< commands to drives
/// Whether the devices of other bodies run, and why not: the results of CommittedView::runs(), senses(),
/// is_on(), works() and is_supplied().
inline constexpr std::string_view k_runs_of_others = "runs";

/// A kind of device: a sensor, which only reads the world, or another device (gripper, light, power pack),
/// which acts on its own body or on other bodies. Each device is on a part of a body and has a state.
struct DeviceKind {
  std::string_view name = {};  ///< name in files: "ranger"
  std::string_view text = {};  ///< description in one sentence, which `troupe describe` prints
  FieldTable params = {};      ///< table of the parameters of a device of this kind
  /// Names of the joints that the device moves; the list is empty if it moves none. If the device moves only
  /// one joint, the name of this joint may be empty.
  std::vector<std::string_view> joints = {};
  /// Whether the device can pick up or release other bodies. If false, World::attach() and World::release()
  /// throw std::logic_error in the hook `apply` of this kind.
  bool carries = false;
  /// Whether the device is a drive device: it moves a part of the body, in the same way as a drive moves the
  /// whole body. The command struct of a drive device must be a Command (command_fields()), and its state
  /// must begin with a Pose, the estimated pose of the device.
  ///
  /// A controller on a part P commands the drive device on P. If P has no drive device, the controller
  /// commands the drive device on the nearest part that carries P. If no part that carries P has a drive
  /// device, the controller commands the drive of the body.
  bool drives = false;
  /// A solid (a rigid shape) of a device, with the joints of the device at rest.
  struct Fixture {
    Solid solid = {};         ///< the solid, device frame
    std::int32_t joint = -1;  ///< index of the device's joint that moves the solid; -1: none
  };
  /// Names of the data of other bodies that `sense` and `act` read. The places of other bodies (SensingView)
  /// need no name. Each name is one of these:
  /// - one of the constants k_..._of_others above;
  /// - the name of a device kind, such as "gripper": the states of all devices of this kind;
  /// - the name of a device kind with the ending "/command", such as "radio/command": the commands to all
  ///   devices of this kind;
  /// - the name of a field, such as "lit": the states of all devices whose first field has this name
  ///   (Prepared::percepts).
  ///
  /// A hook must not read other data of other bodies. If several ranks compute the world together, such data
  /// may be out of date. Tests find wrong reads with the mode World::hide_beyond_reach(), which overwrites
  /// all data of other bodies that have no name in this list.
  std::vector<std::string_view> reads = {};
  /// The bodies that `apply` may change. Tests check this rule with the mode World::hide_beyond_reach(): a
  /// step then throws a StepError if `apply` changes any other body.
  ApplyScope scope = ApplyScope::anything;
  /// Returns the solids that the device adds to its body, in the device frame. Null: it adds none.
  std::vector<Fixture> (*body)(const Record& params) = nullptr;
  /// A device compiled from its parameters: the data of its hooks and the layout of its state.
  struct Prepared {
    std::any data = {};                     ///< the argument `data` of the hooks
    std::vector<StateField> percepts = {};  ///< fields of the device's state table
    /// Size of one row of the state table, bytes, if the state of a body is a struct; otherwise 0. For a
    /// struct, `percepts` must be the list that memory_fields() (engine/kinds/controller.hpp) returns for
    /// this struct.
    std::size_t percept_bytes = 0;
    /// Fields of the command struct, in which controllers write commands to the device. Empty: the device
    /// takes no commands. memory_fields() in engine/kinds/controller.hpp returns the fields of a struct.
    std::vector<StateField> commands = {};
    std::size_t command_bytes = 0;  ///< size of the command struct, bytes
    /// The reach of the device, m: radius of a disc around the origin of the device's body. `sense` and `act`
    /// must not read the data of a body whose enclosing circle is outside the disc. Bodies that move together
    /// with the device's body, because one carries the other, are exempt (SensingView::same_tree()). Tests
    /// check this rule with the mode World::hide_beyond_reach(), which overwrites the data of bodies outside
    /// the disc.
    ///
    /// Joints of the body can shift the device. The engine therefore enlarges the radius by the larger of two
    /// lengths:
    /// - BodyType::joint_reach, a bound on the shift by all joints of the body together;
    /// - if the device is on a joint, the present length of the translation of this joint in
    ///   PublicColumns::joint_mounts.
    double reach_m = 0;
    /// The distance from which the engine chooses the width of the cells of its spatial index, m; not set:
    /// reach_m. The value affects only the speed of a run. Wide cells make short searches slow, for all
    /// devices of the world. A device with a long reach that mostly searches near its body should therefore
    /// set a short distance.
    std::optional<double> cell_hint_m = {};
    /// Number of rays that the device casts each time it runs. The value is used only to check a limit: the
    /// sum over all devices of all types of a world must not exceed 10 million rays. Each type counts once,
    /// however many bodies it has.
    std::size_t beams = 0;
    /// Largest number of effects that the device of one body may emit in a tick (DeviceBatch::emit()),
    /// including the births and deaths that it requests; at most 1,000,000. The engine reserves memory for
    /// the effects of all bodies when it builds the world, and reports an error if the world then takes too
    /// much.
    std::size_t most_effects = 0;
    bool feels_collisions = false;  ///< whether DeviceKind::collide is called
    bool ends_lives = false;        ///< whether the device may request deaths: DeviceBatch::emit_death()
    /// Power that the device draws from its power supply, W. It draws this power while it is in use
    /// (DeviceBatch::senses()) and switched on (DeviceBatch::is_on()), even if a fault has broken it.
    double watts = 0;
    /// Poses of the device's joints at tick 0 or at the birth of the body, relative to rest, m and rad: one
    /// for each name of DeviceKind::joints. Empty: all joints are at rest.
    std::vector<Pose> joints = {};
    double joint_reach_m = 0;  ///< largest horizontal shift of its joints from rest, m; turns do not count
    /// For rangers (range sensors): heading of the beam of each reading in the sensor frame, rad. Field 0 of
    /// `percepts` of a ranger must hold the ranges. Empty for all other devices.
    std::vector<double> bearings = {};
    /// For rangers: the fans of beams, in the order of the readings. Each reading belongs to one fan. Empty
    /// for all other devices.
    std::vector<Transducer> transducers = {};
    std::optional<Camera> camera = {};      ///< for cameras: their images
    std::optional<SoughtMarks> seeks = {};  ///< for fiducial finders: the parts that they detect
  };
  /// Compiles the parameters, which the caller has checked against the limits of `DeviceKind::params`. The
  /// hook must be a pure function. If it throws, building the world reports an error at the position of the
  /// device in the world file.
  ///
  /// pose_body_device: pose of the device in the body frame, with all joints at rest; poses in the parameters
  /// are relative to this pose
  Prepared (*prepare)(const Record& params, const Pose& pose_body_device) = nullptr;
  /// Called after each call of `prepare`: completes `data` (Prepared::data) from the type and from the part
  /// that carries the device. `part` is the index of this part in TypeSpec::parts. The error says why the
  /// type or the part does not suit the device. Null: not needed.
  Result<> (*bind_part)(std::any& data, const TypeSpec& type, std::uint32_t part) = nullptr;
  /// Called after `prepare` and `bind_part`: completes `data` (Prepared::data) from the world. The error says
  /// why the world does not suit the device. Null: not needed.
  Result<> (*bind_world)(std::any& data, const WorldSpec& world) = nullptr;
  /// Called after `bind_part` and `bind_world`: returns a reach, m, that replaces Prepared::reach_m. Kinds
  /// whose reach depends on the part or the world have this hook. Null: the reach is Prepared::reach_m.
  double (*reach_m)(const std::any& data) = nullptr;
  /// Sets the state of the device of one body: row `slot` of `state`. Called when the body enters the world,
  /// at tick 0 or at its birth. All bytes of the row are 0 before the call. Null: they stay 0.
  void (*start)(const std::any& data, StateTable& state, std::size_t slot) = nullptr;
  /// Called in the phase `sense`: writes the percepts of every row of the batch. The hook must read only the
  /// state at the end of the last tick. Returns the number of rays cast. Null: the device senses nothing.
  std::uint64_t (*sense)(const SenseBatch& batch) = nullptr;
  /// Called in the phase `actuate`: executes the commands that controllers gave in earlier ticks. The drives
  /// have already run for the bodies of the batch. Null: the device has no actions.
  void (*act)(const DeviceBatch& batch) = nullptr;
  /// For drive devices (`drives`): sets the velocity in the state of the device to 0, so that the device
  /// starts from rest when it runs again. Called in the phase `actuate`, in each tick in which the device is
  /// stopped for one of these reasons: its body is disabled, a fault has stopped the body or broken the
  /// device, or the power supply of the device is empty. Null: the state has no velocity.
  void (*halt)(StateTable& state, std::size_t slot) = nullptr;
  /// Called after bodies and joints have moved, but only in ticks in which a device of the world called
  /// DeviceBatch::move_joint(). The batches contain all bodies in the world with a device of this kind that
  /// moves joints. DeviceBatch::moved_joint() says whether a joint reached its goal. Null: not needed.
  void (*joints_moved)(const DeviceBatch& batch) = nullptr;
  /// Called after it is decided which bodies move, and before they move, for each motion that was blocked in
  /// this tick: once for the devices of the mover, and once for those of the body that blocked it first. The
  /// bodies that they carry have part in it. The batch has one body. The hook may change the state of the
  /// device, for example so that `sense` reports the collision later. It is called in each tick in which the
  /// device runs (DeviceBatch::runs()), also if the device is not due, with the movers in the order of their
  /// ids; and only if Prepared::feels_collisions is set. It must not throw. Null: not needed.
  void (*collide)(const DeviceBatch& batch, const Collision& collision) = nullptr;
  /// Called after the bodies have moved: applies one effect that a device of this kind emitted with
  /// DeviceBatch::emit(). Effects are applied one by one, in ascending order of (Effect::source,
  /// Effect::device, Effect::sequence). Each call sees the results of the earlier calls. Poses are those
  /// after the motions of the tick, but World::index() still has the bodies at their places before the
  /// motions. Do not call BodyIndex::for_each_near() here, and do not rely on the result true of
  /// World::is_free(): both may miss bodies that have moved. Functions that change the world between two
  /// steps, such as World::set_poses(), throw std::logic_error here and in `born`. Null: the device must not
  /// call emit().
  void (*apply)(World& world, const std::any& data, const Effect& effect) = nullptr;
  /// Receives the result of a birth that the device requested with DeviceBatch::emit_birth(). Called once for
  /// each request, after all other effects and all deaths of the tick. Not called if the body of the device
  /// died in this tick. The hook may change only the state of the device that requested the birth. If several
  /// ranks compute the world, the row of the new body may be on another rank. Null: not needed.
  void (*born)(World& world, const std::any& data, const Effect& effect, const Birth& birth) = nullptr;

  /// For power supplies: returns whether the supply whose state is row `slot` of `state` is empty. The hook
  /// must not throw. Null: the device is not a power supply.
  ///
  /// An empty supply stops the devices that it serves. The devices of a part are served by the supply on that
  /// part or, if the part has none, by the supply on the nearest part that carries it. The supply on the root
  /// part (part 0 of the body) also serves the drive.
  bool (*is_spent)(const std::any& data, const StateTable& state, std::size_t slot) = nullptr;

  bool needs_supply = false;  ///< true: it is an error if no power supply of the body serves the device
  /// Returns the energy account of the device whose state is row `slot` of `state`. Null: the device stores
  /// no energy.
  Energy (*energy)(const StateTable& state, std::size_t slot) = nullptr;
  /// Returns the flags that the device whose state is row `slot` of `state` holds. Null: the device holds no
  /// flags.
  HeldFlags (*flags)(const StateTable& state, std::size_t slot) = nullptr;

  /// True: the device sets the colour of its part. The first field of its state must then have the name
  /// k_shown_color (engine/sensing/shown_color.hpp) and contain the colour: three f32, red, green and blue.
  /// Code that reads recordings finds the field by this name.
  bool shows_color = false;
  FrameLayer layer = FrameLayer::none;  ///< the list of a Frame that `draw` adds to
  /// Draws the device of one body: adds entries to the list of `frame` that `layer` names. For a sensor, the
  /// hook is called only after tick 0, and only while the sensor runs (World::runs()). Null if `layer` is
  /// FrameLayer::none.
  void (*draw)(const DeviceView& view, Frame& frame) = nullptr;

  /// True if the device only senses: the kind has none of the hooks act, apply and born.
  bool is_sensor() const { return act == nullptr && apply == nullptr && born == nullptr; }
};

/// The meaning of the numbers of a command.
enum class ControlMode : std::uint8_t {
  velocity,  ///< speeds, m/s and rad/s; for drives of kind `car`, `turn` is the steering angle, rad
  /// accelerations, m/s^2 and rad/s^2; for drives of kind `car`, `turn` is the steering angle, rad
  acceleration,
  position,  ///< a goal pose, m and rad, in the frame in which the robot estimates its pose (Localization)
};
inline constexpr std::size_t k_control_modes = 3;  ///< number of values of ControlMode

/// The command of a controller to its drive. Speeds and accelerations are in the body frame. Goals are in the
/// frame in which the robot estimates its pose (Localization). An assignment `command = {x, y, turn}` sets
/// all members: it commands a speed and switches all devices on.
struct Command {
  double x = 0;                              ///< forward, m/s or m/s^2; for a goal its x, m
  double y = 0;                              ///< left, m/s or m/s^2; for a goal its y, m
  double turn = 0;                           ///< turn, rad/s or rad/s^2; for a goal its heading, rad
  ControlMode mode = ControlMode::velocity;  ///< meaning of x, y and turn
  /// Devices that controllers have switched off: one bit per device (BodyType::Device::switch_bit).
  std::uint32_t off = 0;
};

/// The fields of a state table with commands: one StateField for each member of Command, in their order.
std::vector<StateField> command_fields();

/// The velocity that a drive gives its body.
struct Velocity {
  double x = 0;     ///< forward, body frame, m/s
  double y = 0;     ///< left, body frame, m/s
  double turn = 0;  ///< counter-clockwise, rad/s
};

/// The argument of the hook DriveKind::drive: robots of one type whose drives run in this tick. There may be
/// no robots. Entry i of each span belongs to robot i, but `estimates` may be empty.
struct DriveBatch {
  std::span<const Command> commands;  ///< the commands to the drives
  /// Output: the velocities that the drives produce from this tick on. If `estimates` is not empty, each
  /// entry contains on input the velocity that the drive computed last. If `estimates` is empty, the input
  /// has no meaning.
  std::span<Velocity> velocities;
  std::span<const Pose> estimates;  ///< estimated poses of the robots; empty if all commands are speeds
  double elapsed_s = 0;             ///< time from one run of these drives to the next, s
};

/// A kind of drive, which computes velocities from commands.
struct DriveKind {
  std::string_view name = {};  ///< name in files: "diff"
  std::string_view text = {};  ///< description in one sentence, which `troupe describe` prints
  FieldTable params = {};      ///< table of the parameters of a drive of this kind
  /// Compiles the parameters to the argument `data` of the other hooks. The hook must accept all parameters
  /// within the limits of `params`, because the engine calls it even if `check` returned an error. If this
  /// hook, `check` or one of those that compute settings throws, building the world reports an error at the
  /// position of the drive in the world file.
  std::any (*prepare)(const Record& params) = nullptr;
  /// Checks that the parameters are consistent. The error says which parameters are inconsistent, and why.
  Result<> (*check)(const Record& params) = nullptr;
  /// Computes the velocities of a batch from the commands, within the limits of the drive. If a computed
  /// velocity, or a command, is not finite, World::step() throws a StepError that names the robot.
  void (*drive)(const std::any& data, const DriveBatch& batch) = nullptr;
  /// Returns the velocity that a robot has until its drive runs for the first time. Null: 0. If it is not
  /// finite, making the world, or the birth of the robot, throws a StepError that names the robot.
  Velocity (*start)(const std::any& data) = nullptr;
  /// Hooks that compute settings from the parameters. The engine itself, not the kind, applies these
  /// settings.
  ///@{
  /// Returns how robots with this drive estimate their poses. The error says why the parameters are
  /// inconsistent. Null: the estimates are the true poses, world frame.
  Result<Localization> (*localization)(const Record& params) = nullptr;
  /// Returns the number of pushable bodies that a robot can push at once. The engine limits the number to the
  /// range from 0 to k_most_pushed (engine/conflicts/conflicts.hpp). Null: 0.
  std::int64_t (*pushes)(const Record& params) = nullptr;
  /// Whether a robot whose motion is blocked may still turn on the spot (class Conflicts, `turning`). Null:
  /// no.
  bool (*turns_when_blocked)(const Record& params) = nullptr;
  /// Returns the highest speed that the limits of the drive allow, m/s. Null: unknown.
  double (*top_speed)(const Record& params) = nullptr;
  ///@}
};

/// The largest number of sensors and other devices that one controller can use.
inline constexpr std::size_t k_most_devices_read = 16;

/// Throws std::out_of_range with a message for the author of a controller: the controller used the device
/// with the index `index`, but it has chosen only `count` devices (ControllerKind::Prepared::devices).
[[noreturn]] void throw_no_device(std::size_t index, std::size_t count);
/// Throws std::logic_error with such a message: the controller commanded a device whose kind takes no
/// commands.
[[noreturn]] void throw_no_command(std::size_t index);
/// Throws std::logic_error with such a message: the controller commanded the device with the index `index` by
/// a struct of `bytes` bytes, but the command struct of the device has `command_bytes` bytes.
[[noreturn]] void throw_wrong_command(std::size_t index, std::size_t bytes, std::size_t command_bytes);
/// Throws std::logic_error with such a message: the controller read the field with the index `field` of a
/// device as values of the type `as`, but the state of the device, `table`, has no such field, or its values
/// have another type. Throws std::out_of_range, as throw_wrong_state() does, if `table` has no name, because
/// there is no device (Readings()).
[[noreturn]] void throw_wrong_field(const StateTable& table, std::size_t field, Element as);
/// Throws std::logic_error with such a message: the controller read the state of a device, `table`, as a
/// struct of `bytes` bytes, but the state of one body has another size.
[[noreturn]] void throw_wrong_state(const StateTable& table, std::size_t bytes);

/// The state of one sensor or other device of one robot, as its controllers read it.
class Readings {
 public:
  Readings() = default;  ///< refers to no device; the functions below throw std::out_of_range
  /// Refers to the state in row `slot` of a device's state table. The table must outlive this object.
  Readings(const StateTable& table, std::size_t slot) : table_(&table), slot_(slot) {}
  /// The values of field f of the state: StateField::columns values. f is an index into the list of the
  /// fields, DeviceKind::Prepared::percepts. T must be the C++ type of the values (StateField::element).
  /// Throws std::logic_error if there is no such field, or if its values have another type.
  template <class T>
  std::span<const T> field(std::size_t f) const {
    const std::span<const StateField> fields = table_->fields();
    if (f >= fields.size() || fields[f].element != element_of<T>())
      throw_wrong_field(*table_, f, element_of<T>());
    return table_->cell<T>(slot_, f);
  }
  /// The whole state as a struct. The fields of the state (DeviceKind::Prepared::percepts) must be the
  /// members of this struct. Throws std::logic_error if the struct has another size than the state; the
  /// members are not checked.
  template <class State>
  const State& as() const {
    if (sizeof(State) != table_->row_bytes()) throw_wrong_state(*table_, sizeof(State));
    return table_->as<State>(slot_);
  }

 private:
  // An empty table, which has no field, so that field() and as() need no comparison for it.
  static const StateTable k_no_device;
  const StateTable* table_ = &k_no_device;
  std::size_t slot_ = 0;
};

/// The inputs of one robot's controller in a tick.
struct Percept {
  std::uint64_t tick = 0;  ///< number of the present tick; the first tick is 1
  double time_s = 0;       ///< simulated time at the end of the tick, s
  double tick_s = 0;       ///< length of a tick, s
  double period_s = 0;     ///< time from one call of the controller for this robot to the next, s
  std::uint32_t body = 0;  ///< id of the robot
  /// States of the sensors and other devices that the controller uses, in the order of
  /// ControllerKind::Prepared::devices. `devices[i]` does not check whether there is a device i. But if there
  /// is none and i is below k_most_devices_read, the functions of the result throw std::out_of_range.
  std::span<const Readings> devices = {};
  /// Estimated pose of the robot, m and rad, in the frame that the Localization of its drive defines
  /// (engine/kinds/localization.hpp). If the controller commands a drive device (DeviceKind::drives):
  /// estimated pose of the drive device, as the state of the drive device gives it.
  Pose estimate = {};
  bool stalled = false;  ///< whether the robot's last motion was blocked or would have left the bounds
  /// What blocked the robot in the last tick; all zero if nothing did, or without
  /// ControllerKind::reads_contacts.
  Contact blocked_by = {};

  /// Ranges that a ranger (range sensor) measured, m, one per beam. `ranger` is the index of the ranger in
  /// `devices`. Throws std::out_of_range if there is no such index. The device must be a ranger: throws
  /// std::logic_error if the first field of its state does not consist of floats.
  std::span<const float> ranges(std::size_t ranger) const {
    if (ranger >= devices.size()) throw_no_device(ranger, devices.size());
    return devices[ranger].field<float>(0);
  }
};

/// The outputs of one robot's controller. An output that the controller does not set keeps its last value.
struct Actions {
  Command& command;  ///< command to the drive device (DeviceKind::drives) or, if there is none, to the drive
  /// Command structs of the devices that the controller uses, as bytes, in the order of Percept::devices;
  /// empty for devices that take no commands.
  std::span<const std::span<std::byte>> devices;
  /// The bits in Command::off by which switch_device() switches the devices that the controller uses, in the
  /// order of Percept::devices. A device that cannot be switched off has the value 0.
  std::span<const std::uint32_t> switches;

  /// Switches a device on or off, from the next tick on. A device that is off does nothing, draws no power
  /// and keeps its last readings. Functions that replace the whole command, such as set_speed(), switch all
  /// devices on again.
  ///
  /// A device can be switched only if its index in BodyType::devices is below 32, and if it is used by a
  /// controller whose kind sets ControllerKind::switches. For other devices the call has no effect.
  ///
  /// chosen: index of the device in Percept::devices, here and below. Throws std::out_of_range if there is no
  /// such index
  void switch_device(std::size_t chosen, bool on) const {
    if (chosen >= switches.size()) throw_no_device(chosen, switches.size());
    command.off = on ? command.off & ~switches[chosen] : command.off | switches[chosen];
  }
  /// Whether the present command leaves a device switched on; true for devices that cannot be switched off.
  bool is_on(std::size_t chosen) const {
    if (chosen >= switches.size()) throw_no_device(chosen, switches.size());
    return (command.off & switches[chosen]) == 0;
  }

  /// Commands a speed, m/s and rad/s, from the next tick on, until the command is replaced. For a car `turn`
  /// is the steering angle, rad.
  void set_speed(double forward, double left, double turn) {
    command = {forward, left, turn, ControlMode::velocity};
  }
  /// Commands an acceleration, m/s^2 and rad/s^2, from the next tick on, until the command is replaced. For a
  /// car `turn` is the steering angle, rad.
  void accelerate(double forward, double left, double turn) {
    command = {forward, left, turn, ControlMode::acceleration};
  }
  /// Commands a goal pose, m and rad, in the same frame as the estimated pose Percept::estimate. From the
  /// next tick on, the robot drives to that pose and stays there, until the command is replaced.
  void go_to(double x, double y, double heading) { command = {x, y, heading, ControlMode::position}; }

  /// The command struct of the device with the index `chosen` in Percept::devices. Its type must be
  /// DeviceCommand. Throws std::out_of_range if there is no such index, and std::logic_error if the kind of
  /// the device takes no commands, or if its command struct has another size; the members are not checked.
  template <class DeviceCommand>
  DeviceCommand& device(std::size_t chosen) const {
    if (chosen >= devices.size()) throw_no_device(chosen, devices.size());
    if (devices[chosen].empty()) throw_no_command(chosen);
    if (sizeof(DeviceCommand) != devices[chosen].size())
      throw_wrong_command(chosen, sizeof(DeviceCommand), devices[chosen].size());
    return *reinterpret_cast<DeviceCommand*>(devices[chosen].data());
  }
};

/// The argument of ControllerKind::decide: robots of one type whose controller decides in this tick, with
/// their data. There may be no robots. Robot i is the robot of row rows[i].
///
/// The *chosen* devices of the type are the devices that the controller uses. They are numbered in the order
/// of ControllerKind::Prepared::devices. This number is the index in `percepts`, `device_commands` and
/// `switches`, and the argument `sensor` of the functions.
struct DecideBatch {
  std::uint64_t tick = 0;                ///< number of the present tick; the first tick is 1
  double time_s = 0;                     ///< simulated time at the end of the tick, s
  double tick_s = 0;                     ///< length of a tick, s
  double period_s = 0;                   ///< time from one decision of a robot to the next, s
  std::uint64_t seed = 0;                ///< seed of the world
  std::uint32_t stream = 0;              ///< number of the controller's random stream: see random()
  std::span<const Row> rows;             ///< rows of the batch
  std::span<const BodyId> ids;           ///< id of each row of the world
  std::span<const std::uint32_t> slots;  ///< slot of each row of the world in the tables of its type
  std::span<Command> commands;           ///< drive command of each row of the world
  std::span<const std::uint8_t> stalls;  ///< component `stall` of each row of the world; empty: none stalls
  /// Component `contact` of each row of the world; empty if the state does not have it.
  std::span<const Contact> contacts;
  Estimates estimates;  ///< estimated poses of the robots, as their drives estimate them

  /// The rows of one state table of the type. The table has one row per robot of the type, indexed by slot.
  struct Rows {
    std::byte* first = nullptr;  ///< slot 0; null: there is no such table
    std::size_t row_bytes = 0;   ///< distance from one slot to the next, bytes

    /// The row of a slot; null if there is no table.
    std::byte* of(std::size_t slot) const { return first == nullptr ? nullptr : first + slot * row_bytes; }
  };
  /// State of the chosen devices. Only the first `devices` elements are set.
  std::array<const StateTable*, k_most_devices_read> percepts;
  std::array<Rows, k_most_devices_read> device_commands;      ///< commands to the chosen devices
  std::array<std::uint32_t, k_most_devices_read> switches{};  ///< bits of the chosen devices in Command::off
  std::size_t devices = 0;                                    ///< number of chosen devices
  Rows memories;  ///< memory structs of the controller; without rows if its kind has no memory
  /// Commands to the drive device (DeviceKind::drives) that the controller commands. If the controller
  /// commands the drive of the body instead, there are no rows, and the command is in `commands`.
  Rows drive_commands = {};
  /// State of the drive device that the controller commands. The state begins with the estimated pose of the
  /// drive device. Null if the controller commands the drive of the body.
  const StateTable* drive_state = nullptr;

  std::size_t size() const { return rows.size(); }  ///< number of robots in the batch
  /// Row of robot i. Throws std::out_of_range if i is not below size(), as all functions below do. If
  /// `sensor` is not below `devices`, the functions below throw std::out_of_range, too.
  Row row(std::size_t i) const {
    if (i >= rows.size()) throw_no_robot(i, rows.size());
    return rows[i];
  }
  std::uint32_t body(std::size_t i) const { return ids[row(i).index()].value; }  ///< id of robot i
  /// Slot of robot i in the tables of its type.
  std::size_t slot(std::size_t i) const { return slots[row(i).index()]; }
  /// Command that the controller of robot i gives, for reading and writing. This is the command to the drive
  /// device that the controller commands or, if there is none, to the drive of the body.
  Command& command(std::size_t i) const {
    if (drive_commands.first == nullptr) return commands[row(i).index()];
    return *reinterpret_cast<Command*>(drive_commands.of(slot(i)));
  }
  /// Estimated pose of robot i. If the controller commands a drive device, this is the estimated pose of the
  /// drive device.
  Pose estimate(std::size_t i) const {
    if (drive_state != nullptr) return drive_state->as<Pose>(slot(i));
    return estimates.of(row(i), slot(i));
  }
  /// Whether the last motion of robot i was blocked, or would have left the bounds of the world.
  bool stalled(std::size_t i) const {
    const std::size_t r = row(i).index();
    return !stalls.empty() && stalls[r] != 0;
  }
  /// What blocked robot i in the last tick; all zero if nothing did, or if the state does not say so
  /// (ControllerKind::reads_contacts).
  Contact blocked_by(std::size_t i) const {
    const std::size_t r = row(i).index();
    return contacts.empty() ? Contact() : contacts[r];
  }
  /// The random numbers of robot i in this tick. Each call returns the same sequence from its beginning.
  Random random(std::size_t i) const { return {seed, stream, body(i), static_cast<std::uint32_t>(tick)}; }
  /// Memory of robot i; null if the kind has none.
  std::byte* memory(std::size_t i) const { return memories.of(slot(i)); }
  /// State table of a chosen device.
  const StateTable& percepts_of(std::size_t sensor) const {
    if (sensor >= devices) throw_no_device(sensor, devices);
    return *percepts[sensor];
  }
  /// Readings of a chosen device of robot i.
  Readings readings(std::size_t sensor, std::size_t i) const { return {percepts_of(sensor), slot(i)}; }
  /// Ranges that a chosen ranger of robot i measured, m, one number per beam. The device must be a ranger:
  /// throws std::logic_error if the first field of its state does not consist of floats.
  std::span<const float> ranges(std::size_t sensor, std::size_t i) const {
    return readings(sensor, i).field<float>(0);
  }
  /// Command struct of a chosen device of robot i; null if its kind takes no commands.
  std::byte* device_command(std::size_t sensor, std::size_t i) const {
    if (sensor >= devices) throw_no_device(sensor, devices);
    return device_commands[sensor].of(slot(i));
  }
};

/// An exception of a controller, together with the robot for which the controller was called. If
/// ControllerKind::decide throws a DecisionError, the error message of the step names this robot. For any
/// other exception, the message names the first robot of the batch. If the batch has several robots, the
/// message also says how many.
struct DecisionError {
  Row row;                    ///< row of the robot in the state tables
  std::exception_ptr thrown;  ///< the controller's exception
};

/// A device of a type, as described to ControllerKind::prepare, which chooses the devices that a controller
/// uses.
struct DeviceInfo {
  std::string_view name;                 ///< name of the device (BodyType::Device::name)
  std::string_view kind;                 ///< kind of the device (DeviceKind::name)
  const DeviceKind::Prepared& prepared;  ///< the compiled device
  /// Pose of the device in the body frame, with all joints at rest, m and rad. If the controller commands a
  /// drive device (DeviceKind::drives): pose in the frame of the drive device.
  Pose pose = {};
};

/// A kind of controller. A controller computes commands from the state of devices and from its memory.
struct ControllerKind {
  std::string_view name = {};  ///< name in files: "wander"
  std::string_view text = {};  ///< description in one sentence, which `troupe describe` prints
  FieldTable params = {};      ///< table of the parameters of a controller of this kind
  bool needs_drive = true;     ///< false: bodies without a drive may also have the controller
  bool switches = false;       ///< whether controllers of this kind may call Actions::switch_device()
  /// Whether controllers of this kind read what blocked their robots: Percept::blocked_by,
  /// DecideBatch::blocked_by(). The state then has the component `contact`.
  bool reads_contacts = false;
  /// True: one call of `decide` decides for all robots of a type that decide in a tick. The batch has them in
  /// the order of their ids, and the commands may depend on all of them. The call is made on the thread that
  /// steps the world, after the calls of all controllers for which this member is false. If several ranks
  /// compute the world together, the call is made on rank 0. Controllers in other languages set this member,
  /// because each call into another language is slow.
  bool is_collective = false;
  /// Fields of the memory struct that the engine keeps for each robot; empty: the controller has no memory.
  std::vector<StateField> memory = {};
  std::size_t memory_bytes = 0;  ///< size of the memory struct, bytes
  /// Initialises the memory struct of a robot at tick 0 or at its birth. The hook must set every field,
  /// whatever the bytes of the struct held before. `troupe check --controllers` tests this rule: it calls
  /// the hook on two memories that are filled with different bytes. Not called if the controller has no
  /// memory.
  void (*start)(std::byte* memory) = nullptr;

  /// A controller compiled from its parameters.
  struct Prepared {
    std::any data = {};  ///< the argument `data` of `decide`
    /// The devices that the controller uses, at most k_most_devices_read: indices into the argument `devices`
    /// of `prepare`. The controller decides in the ticks in which the first of these devices is due, even if
    /// that device is switched off, broken or without power. If the controller uses no devices, it decides in
    /// the ticks in which the drive of the body is due. If there is no drive either, it decides once per
    /// ControllerSpec::period_s.
    std::vector<std::size_t> devices = {};
  };
  /// Compiles the parameters and chooses the devices that the controller uses. The text of the error says
  /// what the type lacks. It must continue the words `controller "NAME"`, for example with `needs a device of
  /// kind "ranger"`.
  ///
  /// devices: the devices that the controller may use: those on its part and on all parts mounted on that
  /// part, except drive devices (DeviceKind::drives). They have the parameters of tick 0, also if the hook is
  /// called because an intervention or World::set() changes a parameter later in the run
  /// claimed: one entry per entry of `devices`; true: an earlier controller in the type's list has reserved
  /// the device for itself. The hook reserves a device by setting the entry to true. It must not change the
  /// number of entries
  Result<Prepared> (*prepare)(const Record& params, std::span<const DeviceInfo> devices,
                              std::vector<bool>& claimed) = nullptr;
  /// Called after each call of `prepare`: completes `data` (Prepared::data) from the world, the type and the
  /// part of the controller, for example from a floor plan. `part` is the index of this part in
  /// TypeSpec::parts. The error says why the world or the type does not suit the controller. Null: not
  /// needed.
  Result<> (*bind_world)(std::any& data, const WorldSpec& world, const TypeSpec& type,
                         std::uint32_t part) = nullptr;
  /// Kinds of devices, such as "flags", that the controller needs and that Stage files do not declare. The
  /// loader of Stage files adds a device of each of these kinds to each model with this controller, unless
  /// the model has a device of that kind. The added devices have default parameters. Other loaders add no
  /// devices.
  std::vector<std::string_view> brings = {};
  /// Decides for all robots of the batch: sets their commands and memories. make_controller_kind() makes this
  /// hook from a function that decides for one robot.
  void (*decide)(const std::any& data, const DecideBatch& batch) = nullptr;
};

/// All kinds that a world can use. A registry is passed as an argument and is never global.
/// troupe/registry.cpp assembles the registry with all kinds of Troupe.
struct Registry {
  std::vector<ModelKind> models;            ///< model kinds of Stage files
  std::vector<DeviceKind> devices;          ///< kinds of sensors and of other devices
  std::vector<DriveKind> drives;            ///< kinds of drives
  std::vector<ControllerKind> controllers;  ///< kinds of controllers
  std::vector<MeasureKind> measures;        ///< kinds of measures
  std::vector<FaultKind> faults;            ///< kinds of faults

  /// A name for a controller kind with certain parameters, such as Stage's expand_swarm.
  struct Preset {
    std::string_view name;                                   ///< name in files
    std::string_view kind;                                   ///< name of the controller kind
    std::string_view text;                                   ///< one sentence that `troupe describe` prints
    std::vector<std::pair<std::string_view, Value>> params;  ///< parameters that differ from the defaults
  };
  std::vector<Preset> presets;  ///< presets; no preset has the name of a controller kind

  /// Finds a controller in the plug-ins (troupe/plugins.hpp). It is called for a name that is not in the
  /// lists above. If no plug-in has the name, it returns an error that begins with the text `unknown`;
  /// details such as the searched folders may follow. The returned kind lives as long as the registry and its
  /// copies. Empty: there are no plug-ins. A Simulation sets this callback and the two below in its copy of
  /// the registry.
  std::function<Result<const ControllerKind*>(std::string_view name, std::string unknown)>
      plugged_controllers;
  /// Callbacks that find a device or a measure in the plug-ins, in the same way as `plugged_controllers`
  /// finds a controller.
  ///@{
  std::function<Result<const DeviceKind*>(std::string_view name, std::string unknown)> plugged_devices;
  std::function<Result<const MeasureKind*>(std::string_view name, std::string unknown)> plugged_measures;
  ///@}

  /// The kind with this name in the lists above; null if there is none. device() and controller() also search
  /// the plug-ins. The name of a preset is never searched in plug-ins: controller() returns null for it. The
  /// pointer is valid as long as the lists are not changed.
  ///@{
  const ModelKind* model(std::string_view name) const;
  const DeviceKind* device(std::string_view name) const;
  const DriveKind* drive(std::string_view name) const;
  const ControllerKind* controller(std::string_view name) const;
  ///@}
  /// The device kind with this name, in the list `devices` or in a plug-in; never null. If there is none, the
  /// error is the text `unknown`, to which `plugged_devices` may add details.
  Result<const DeviceKind*> find_device(std::string_view name, std::string unknown) const;
  /// The controller kind with this name, in the list `controllers` or in a plug-in; never null. If there is
  /// none, the error begins with `unknown controller "hover"; known: expand, ...`. A preset is not a
  /// controller kind, so the name of a preset also gives this error.
  Result<const ControllerKind*> find_controller(std::string_view name) const;
  /// The measure with this name, in the list `measures` or in a plug-in; never null. If there is none, the
  /// error begins with `unknown measure "stals"; known: alive, ...`.
  Result<const MeasureKind*> find_measure(std::string_view name) const;
  /// Names of the controllers and presets in the lists, sorted.
  std::vector<std::string_view> controller_names() const;
  /// The preset, measure or fault with this name in the lists; null if there is none. Plug-ins are not
  /// searched.
  ///@{
  const Preset* preset(std::string_view name) const;
  const MeasureKind* measure(std::string_view name) const;
  const FaultKind* fault(std::string_view name) const;
  ///@}

  /// The device kinds of the list `devices` that only sense (DeviceKind::is_sensor()).
  std::vector<DeviceKind> sensors() const;
  std::vector<DeviceKind> other_devices() const;  ///< the kinds of `devices` that are not sensors
};

}  // namespace troupe::engine
