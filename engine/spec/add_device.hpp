#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::engine {

/// Adds a device, and the joints that its kind moves (DeviceKind::joints), to a type. device.part,
/// device.joint and device.pose_body_device must say where the device is mounted; the new joints are at the
/// same place. The function sets device.moves if the kind has joints. A joint is named after the device, or
/// after the kind if the device has no name. If the kind has several joints, `/` and the joint's own name
/// (DeviceKind::joints) follow. If the type already has a joint of that name, `#2` (or `#3`, ...) follows.
/// Returns the index of the device in type.devices. `kind` must be the kind that device.kind names.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);

/// Adds the solids of a device (DeviceKind::body) to its type; it has no effect if the kind has none. Solids
/// that no joint moves are added to the part that carries the device. For each joint that moves solids, a new
/// part with these solids is added; it has the properties of the part that carries the device. If the hook
/// DeviceKind::body throws an exception, this function throws std::runtime_error and leaves the type
/// unchanged. `device` is the index of the device in type.devices. Call this once, after add_device().
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
