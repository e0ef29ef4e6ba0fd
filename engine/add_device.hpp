#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::engine {

/// Adds a device to a type, with the joints that its kind moves: device.part and device.joint say what it
/// stands on, device.moves is set here. Returns its index in type.devices.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);

/// Adds the body that the kind of a device brings along: what is rigid to the device's own part, and a part
/// for each joint that moves some of it. Throws std::runtime_error where the kind throws.
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
