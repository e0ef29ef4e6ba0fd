#include "engine/ranks/sharing.hpp"

#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>

namespace troupe::engine {
namespace {

/// Whether devices of this kind have hooks that the phase move calls. In a replicated world, every rank calls
/// them for all rows, not only for its own.
bool moves(const DeviceKind& kind) {
  return kind.joints_moved != nullptr || kind.apply != nullptr || kind.born != nullptr;
}

/// Whether a device of the world declares that it reads the data `name` of other bodies (DeviceKind::reads).
bool is_read(const World& world, std::string_view name) {
  return std::ranges::any_of(world.view().types(), [&](const BodyType& type) {
    return std::ranges::any_of(type.devices, [&](const BodyType::Device& device) {
      return std::ranges::find(device.kind->reads, name) != device.kind->reads.end();
    });
  });
}

/// Whether other bodies or the phase move may read the states of devices of this kind. If not, only the
/// device itself and the controllers of its own body read its state.
bool shows_state(const World& world, const DeviceKind& kind) {
  return !kind.is_sensor() || kind.shows_color || kind.is_spent != nullptr || moves(kind) ||
         is_read(world, kind.name);
}

/// Whether other bodies or the phase move may read the commands to devices of this kind. If not, only the
/// devices themselves read their commands.
bool shows_commands(const World& world, const DeviceKind& kind) {
  return moves(kind) || is_read(world, fmt::format("{}/command", kind.name));
}

}  // namespace

std::vector<Sharing> sharing_of(const World& world) {
  const std::span<const StateTable> tables = world.tables();
  std::vector<Sharing> sharing(tables.size(), Sharing::alike);
  const auto of = [&](std::string_view component) -> Sharing& {
    return sharing[static_cast<std::size_t>(std::ranges::find(tables, component, &StateTable::component) -
                                            tables.begin())];
  };
  of("velocity") = Sharing::sent;
  if (std::ranges::find(tables, "contact", &StateTable::component) != tables.end())
    of("contact") = Sharing::kept;
  of("command") = is_read(world, k_command_of_others) ? Sharing::sent : Sharing::kept;
  const bool is_running_read = is_read(world, k_runs_of_others);
  for (const BodyType& type : world.view().types()) {
    for (const BodyType::Device& device : type.devices) {
      if (device.table == 0) continue;  // the type has no rows, and so its devices have no tables
      const std::span<const StateField> fields = tables[device.table].fields();
      const bool is_sent =
          shows_state(world, *device.kind) || (!fields.empty() && is_read(world, fields.front().name));
      sharing[device.table] = is_sent ? Sharing::sent : Sharing::kept;
      if (device.command_table)
        sharing[*device.command_table] =
            shows_commands(world, *device.kind) || (is_running_read && device.kind->drives) ? Sharing::sent
                                                                                            : Sharing::kept;
      // A bit of the command to the drive says whether the device is switched on.
      if (is_running_read && device.switch_bit != 0) of("command") = Sharing::sent;
    }
    for (const BodyType::Controller& controller : type.controllers)
      if (controller.table) sharing[*controller.table] = Sharing::kept;
  }
  return sharing;
}

}  // namespace troupe::engine
