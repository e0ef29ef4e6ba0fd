#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/random.hpp"
#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/commands.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/device_batch.hpp"
#include "engine/kinds/device_kind.hpp"
#include "engine/kinds/localization.hpp"
#include "engine/kinds/percept.hpp"

#include <any>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

struct LintView;  // engine/observing/lint_view.hpp
struct TypeSpec;
struct WorldSpec;

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
  /// The same as DeviceKind::lint, for a controller.
  void (*lint)(const std::any& data, const LintView& view) = nullptr;
};

}  // namespace troupe::engine
