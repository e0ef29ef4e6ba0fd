#include "engine/kinds/controller.hpp"

#include <algorithm>
#include <exception>
#include <numeric>
#include <string>

namespace troupe::engine::detail {
namespace {

/// Returns the error of a controller that finds no device of this kind among those of its robot. more: it has
/// already found other devices.
Error no_device_of(std::string_view kind, bool more, std::span<const DeviceInfo> devices) {
  std::string text(more ? "needs one more device of kind \"" : "needs a device of kind \"");
  text.append(kind).append("\"");
  for (const DeviceInfo& device : devices)
    text.append(&device == devices.data() ? "; the devices of the robot are of the kinds " : ", ")
        .append(device.kind);
  return {std::move(text)};
}

/// Returns the first name in a comma-separated list of names, without spaces around it, and removes it from
/// the list.
std::string_view take_name(std::string_view& names) {
  std::string_view name = names.substr(0, names.find(','));
  names.remove_prefix(std::min(name.size() + 1, names.size()));
  while (name.starts_with(' ')) name.remove_prefix(1);
  while (name.ends_with(' ')) name.remove_suffix(1);
  return name;
}

}  // namespace

Result<std::vector<std::size_t>> devices_of(std::span<const std::string_view> kinds,
                                            std::span<const DeviceInfo> devices) {
  std::vector<std::size_t> chosen;
  for (const std::string_view kind : kinds) {
    std::size_t d = 0;
    while (d < devices.size() && (devices[d].kind != kind || std::ranges::count(chosen, d) > 0)) ++d;
    if (d == devices.size()) return no_device_of(kind, !chosen.empty(), devices);
    chosen.push_back(d);
  }
  return chosen;
}

std::vector<std::size_t> all_devices(std::span<const DeviceInfo> devices) {
  std::vector<std::size_t> chosen(devices.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  return chosen;
}

void throw_decision_error(Row row) { throw DecisionError{row, std::current_exception()}; }

std::vector<StateField> listed_fields(std::string_view names, std::span<const ListedMember> members) {
  std::vector<StateField> fields;
  for (const ListedMember& member : members)
    fields.push_back({.name = std::string(take_name(names)),
                      .element = member.element,
                      .columns = member.columns,
                      .offset = member.offset,
                      .is_bool = member.is_bool});
  return fields;
}

ControllerKind controller_kind(std::string_view name, std::string_view text, const FieldTable& (*params)(),
                               std::vector<StateField> (*memory)(), std::size_t memory_bytes) {
  ControllerKind kind{.name = name, .text = text, .memory = memory()};
  if (params != nullptr) kind.params = params();
  kind.memory_bytes = kind.memory.empty() ? 0 : memory_bytes;
  return kind;
}

Result<ControllerKind::Prepared> prepared_controller(std::any controller,
                                                     Result<std::vector<std::size_t>> devices) {
  if (!devices) return devices.error();
  return ControllerKind::Prepared{std::move(controller), *std::move(devices)};
}

}  // namespace troupe::engine::detail
