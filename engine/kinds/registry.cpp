#include "engine/kinds/registry.hpp"

#include "base/diagnostics.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace troupe::engine {
namespace {

template <class Kind>
const Kind* find(const std::vector<Kind>& kinds, std::string_view name) {
  const auto it = std::ranges::find(kinds, name, &Kind::name);
  return it == kinds.end() ? nullptr : &*it;
}

/// Throws std::out_of_range if the table is that of a default-constructed Readings.
void refuse_no_device(const StateTable& table) {
  if (table.component().empty())
    throw std::out_of_range("reads a device that it has not chosen: Percept::devices has fewer devices");
}

}  // namespace

std::vector<StateField> command_fields() {
  return {
      {"x", Element::f64, 1, "m/s", "forward speed or acceleration, or x of the goal pose: see `mode`",
       offsetof(Command, x)},
      {"y", Element::f64, 1, "m/s", "speed or acceleration to the left, or y of the goal pose: see `mode`",
       offsetof(Command, y)},
      {"turn", Element::f64, 1, "rad/s",
       "turn rate or angular acceleration, counter-clockwise, or heading of the goal pose: see `mode`; for a "
       "car drive in the modes 0 and 1, the steering angle (rad)",
       offsetof(Command, turn)},
      {"mode", Element::u8, 1, "",
       "meaning of x, y and turn: 0: speeds, 1: accelerations (m/s^2, rad/s^2), 2: a goal pose (m, rad)",
       offsetof(Command, mode), true},
      {"off", Element::u32, 1, "",
       "devices that are switched off: bit d stands for device d of the type, counted from 0",
       offsetof(Command, off), true}};
}

void throw_no_device(std::size_t index, std::size_t count) {
  throw std::out_of_range("uses its device with the index " + std::to_string(index) +
                          " (counted from 0), but has chosen only " + std::to_string(count) + " devices");
}

void throw_no_contacts() {
  throw std::logic_error(
      "this world does not note what blocks its bodies: add \"contacts\": true to the world file, or set "
      "this key when you load it (in C++: SimulationOptions::contacts; in Python: set={\"/contacts\": "
      "True})");
}

void throw_no_robot(std::size_t index, std::size_t count) {
  throw std::out_of_range("uses the robot with the index " + std::to_string(index) +
                          " (counted from 0) of a batch of " + std::to_string(count) + " robots");
}

void throw_no_command(std::size_t index) {
  throw std::logic_error("commands its device with the index " + std::to_string(index) +
                         " (counted from 0), but the kind of this device takes no commands");
}

void throw_wrong_command(std::size_t index, std::size_t bytes, std::size_t command_bytes) {
  throw std::logic_error("commands its device with the index " + std::to_string(index) +
                         " (counted from 0) by a struct of " + std::to_string(bytes) +
                         " bytes, but the command struct of this device has " +
                         std::to_string(command_bytes) + " bytes");
}

const StateTable Readings::k_no_device{};

void throw_wrong_field(const StateTable& table, std::size_t field, Element as) {
  refuse_no_device(table);
  const std::string reads = "reads the field with the index " + std::to_string(field) +
                            " (counted from 0) of the device \"" + table.component() + "\" as " +
                            std::string(element_name(as)) + ", but ";
  const std::span<const StateField> fields = table.fields();
  if (field >= fields.size())
    throw std::logic_error(reads + "the device has only " + std::to_string(fields.size()) + " fields");
  throw std::logic_error(reads + "this field, \"" + fields[field].name + "\", has the type " +
                         std::string(element_name(fields[field].element)));
}

void throw_wrong_state(const StateTable& table, std::size_t bytes) {
  refuse_no_device(table);
  throw std::logic_error("reads the state of the device \"" + table.component() + "\" as a struct of " +
                         std::to_string(bytes) + " bytes, but the state has " +
                         std::to_string(table.row_bytes()) + " bytes");
}
const ModelKind* Registry::model(std::string_view name) const { return find(models, name); }
const DeviceKind* Registry::device(std::string_view name) const {
  const auto found = find_device(name, {});
  return found ? *found : nullptr;
}
Result<const DeviceKind*> Registry::find_device(std::string_view name, std::string unknown) const {
  if (const DeviceKind* kind = find(devices, name)) return kind;
  if (plugged_devices) return plugged_devices(name, std::move(unknown));
  return Error{std::move(unknown)};
}
const DriveKind* Registry::drive(std::string_view name) const { return find(drives, name); }
const ControllerKind* Registry::controller(std::string_view name) const {
  const auto found = find_controller(name);
  return found ? *found : nullptr;
}
Result<const ControllerKind*> Registry::find_controller(std::string_view name) const {
  if (const ControllerKind* kind = find(controllers, name)) return kind;
  std::string unknown = unknown_name("controller", name, controller_names());
  if (plugged_controllers && !preset(name)) return plugged_controllers(name, std::move(unknown));
  return Error{std::move(unknown)};
}
Result<const MeasureKind*> Registry::find_measure(std::string_view name) const {
  if (const MeasureKind* kind = measure(name)) return kind;
  std::string unknown = unknown_name("measure", name, name_list(measures));
  if (plugged_measures) return plugged_measures(name, std::move(unknown));
  return Error{std::move(unknown)};
}
std::vector<std::string_view> Registry::controller_names() const {
  std::vector<std::string_view> names;
  for (const ControllerKind& kind : controllers) names.push_back(kind.name);
  for (const Preset& each : presets) names.push_back(each.name);
  std::ranges::sort(names);
  return names;
}
const Registry::Preset* Registry::preset(std::string_view name) const { return find(presets, name); }
const MeasureKind* Registry::measure(std::string_view name) const { return find(measures, name); }
const FaultKind* Registry::fault(std::string_view name) const { return find(faults, name); }

std::vector<DeviceKind> Registry::sensors() const {
  std::vector<DeviceKind> kinds = devices;
  std::erase_if(kinds, [](const DeviceKind& kind) { return !kind.is_sensor(); });
  return kinds;
}

std::vector<DeviceKind> Registry::other_devices() const {
  std::vector<DeviceKind> kinds = devices;
  std::erase_if(kinds, [](const DeviceKind& kind) { return kind.is_sensor(); });
  return kinds;
}

}  // namespace troupe::engine
