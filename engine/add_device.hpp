#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::engine {

/// Adds a device, and the joints that its kind moves, to a type. device.part and device.joint must say where
/// the device is mounted. The function sets device.moves. Returns the index of the device in type.devices.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);

/// Adds the solids of a device (DeviceKind::body) to its type. Solids that no joint moves are added to the
/// part that carries the device. The solids that a joint moves are added to a new part, one for each such
/// joint. Throws std::runtime_error if the kind throws an exception. `device` is the index of the device in
/// type.devices.
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
