#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::engine {

/// Adds a device, and the joints that its kind moves, to a type. device.part and device.joint say where it is
/// mounted; device.moves is set here. Returns its index in type.devices.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);

/// Adds the solids of a device (DeviceKind::body) to its type. Solids that no joint moves are added to the
/// device's part, the others to a new part for each joint. Throws std::runtime_error if the kind throws.
/// device: its index in type.devices
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
