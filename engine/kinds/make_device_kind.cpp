#include "engine/kinds/make_device_kind.hpp"

#include <stdexcept>

namespace troupe::engine::detail {

void complete(DeviceKind::Prepared& prepared, bool holds_class, const DeviceStruct& state,
              const DeviceStruct& command) {
  if (!holds_class)
    throw std::logic_error(
        "prepare() must return a DeviceKind::Prepared whose `data` holds the device class itself");
  if (state.fields != nullptr && prepared.percepts.empty()) {
    prepared.percepts = state.fields();
    prepared.percept_bytes = state.bytes;
  }
  if (command.fields != nullptr && prepared.commands.empty()) {
    prepared.commands = command.fields();
    prepared.command_bytes = command.bytes;
  }
}

DeviceKind device_kind(std::string_view name, std::string_view text, const FieldTable& (*params)()) {
  DeviceKind kind{.name = name, .text = text};
  if (params != nullptr) kind.params = params();
  return kind;
}

}  // namespace troupe::engine::detail
