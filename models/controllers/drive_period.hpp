#pragma once

#include "engine/kinds/percept.hpp"
#include "engine/spec/world_spec.hpp"
#include "models/controllers/decisions.hpp"

#include <cstdint>

namespace troupe::models {

/// Returns the device `wheels` that a controller on the part `part` commands: that of this part or of the
/// nearest part that carries it. The result is null if there is none: the controller then commands the drive
/// of the body, if the body has one.
const engine::DeviceSpec* wheels_of(const engine::TypeSpec& type, std::uint32_t part);

/// Returns the number of ticks between two runs of the drive that a controller on the part `part` commands:
/// wheels_of() or, without such a device, the drive of the body. A command acts from the next run of the
/// drive. The result is 1 if the body has no drive.
std::uint64_t drive_period(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part);

/// Returns the number of decisions (calls of a controller) until the controller surely sees that its command
/// has moved the robot, unless an obstacle stops it. The result is at least 2.
///
/// period: ticks between two runs of the drive, from drive_period()
inline std::uint32_t decisions_to_move(std::uint64_t period, const engine::Percept& percept) {
  return 1 + decisions_for(static_cast<double>(period) * percept.tick_s, percept.period_s);
}

}  // namespace troupe::models
