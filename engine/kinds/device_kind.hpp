#pragma once

#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/device_batch.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/kinds/energy.hpp"

#include <any>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

class Collision;
class CommittedView;
class EffectContext;
struct Frame;
struct LintView;  // engine/observing/lint_view.hpp
struct TypeSpec;
struct WorldSpec;

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

/// The flags that a device holds. A flag is a coloured token that bodies hold and exchange, as in Stage.
struct HeldFlags {
  std::size_t count = 0;       ///< number of flags that the device holds now
  std::uint64_t received = 0;  ///< number received from other bodies since the device came into the world
};

/// The argument of the hook DeviceKind::draw, which draws the device of one body. The hook adds its drawings
/// to a Frame, the picture of the world at one tick.
struct DeviceView {
  const CommittedView& world;  ///< the world, between two ticks
  const std::any& data;        ///< the compiled parameters of the device (DeviceKind::Prepared::data)
  const StateTable& state;     ///< state of the device, by slot
  std::size_t slot = 0;        ///< slot of the body: index of its row in `state`
  std::uint32_t body = 0;      ///< index of the body in Frame::mobile, the list of bodies
  Pose pose_world_device;      ///< present pose, world frame, m and rad; includes the displacement of joints

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

// A *kind* is a table of functions, called *hooks*, that implements one sort of device, drive or controller.
// When the world is built, the hook `prepare` converts the parameters to data of a type that the kind
// chooses. Most other hooks receive these data, together with a batch or a single body. Several threads call
// the hooks at once, so a hook may write only to its arguments. If a hook throws an exception during a step,
// World::step() throws a StepError. If DeviceKind::draw, energy or flags throws between two steps, the
// caller gets a std::runtime_error that names the device and the robot. Only the hook DeviceKind::is_spent
// must not throw.

/// A kind of device: a sensor, which only reads the world, or another device (gripper, light, power pack),
/// which acts on its own body or on other bodies. Each device is on a part of a body and has a state.
struct DeviceKind {
  std::string_view name = {};  ///< name in files: "ranger"
  std::string_view text = {};  ///< description in one sentence, which `troupe describe` prints
  FieldTable params = {};      ///< table of the parameters of a device of this kind
  /// Names of the joints that the device moves; the list is empty if it moves none. If the device moves only
  /// one joint, the name of this joint may be empty.
  std::vector<std::string_view> joints = {};
  /// Whether the device can pick up or release other bodies. If false, Gripping::attach() and
  /// Gripping::release() throw std::logic_error in the hook `apply` of this kind.
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
    std::optional<Camera> camera = {};  ///< for cameras: their images
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
  /// Effect::device, Effect::sequence). Each call sees the results of the earlier calls. The views of
  /// engine/links/effect_views.hpp give access to what the hook may see and change. Poses are those after the
  /// motions of the tick, but the spatial index still has the bodies at their places before the motions.
  /// Null: the device must not call emit().
  void (*apply)(const EffectContext& context, const std::any& data, const Effect& effect) = nullptr;
  /// Receives the result of a birth that the device requested with DeviceBatch::emit_birth(). Called once for
  /// each request, after all other effects and all deaths of the tick. Not called if the body of the device
  /// died in this tick. The hook may change only the state of the device that requested the birth. If several
  /// ranks compute the world, the row of the new body may be on another rank. Null: not needed.
  void (*born)(const EffectContext& context, const std::any& data, const Effect& effect,
               const Birth& birth) = nullptr;

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
  /// hook is called only after tick 0, and only while the sensor runs (CommittedView::runs()). Null if
  /// `layer` is FrameLayer::none.
  void (*draw)(const DeviceView& view, Frame& frame) = nullptr;
  /// Reports probable mistakes in a world that concern one device of a type, for `troupe lint`. Called once
  /// for each device of each type that has bodies, after the world has been built without errors. The class
  /// of `view` is declared in engine/observing/lint_view.hpp. Null: there is nothing to look for.
  void (*lint)(const std::any& data, const LintView& view) = nullptr;

  /// True if the device only senses: the kind has none of the hooks act, apply and born.
  bool is_sensor() const { return act == nullptr && apply == nullptr && born == nullptr; }
};

}  // namespace troupe::engine
