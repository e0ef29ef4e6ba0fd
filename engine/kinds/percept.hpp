#pragma once

#include "base/pose.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/commands.hpp"
#include "engine/kinds/components.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::engine {

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

}  // namespace troupe::engine
