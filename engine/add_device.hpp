#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::engine {

/// Adds a device, and the joints that its kind moves, to a type. device.part and device.joint say where it is
/// mounted; device.moves is set here. Returns its index in type.devices.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);

/// Adds the solids that the kind of a device brings: rigid ones to the device's own part, the others to a new
/// part per joint. Throws std::runtime_error if the kind throws.
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
