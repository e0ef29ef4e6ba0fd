#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::engine {

/// Adds a device (a sensor or an actuator), and the joints that it moves, to a body type, which is what
/// identical bodies share. `kind` must be the kind that device.kind names: the table of functions that
/// implements the device. Its member DeviceKind::joints lists the joints. device.part, device.joint and
/// device.pose_body_device must say where the device is mounted. Each new joint has the parent joint
/// device.joint and the rest pose device.pose_body_device. If the kind has joints, the function sets the
/// member `moves` of the added device to the first of them.
///
/// A joint is named after the device, or after the kind if the device has no name. If the kind has several
/// joints, `/` and the joint's own name (DeviceKind::joints) follow. If the type already has a joint of that
/// name, `#2` (or `#3`, ...) follows. Returns the index of the device in type.devices.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);

/// Adds the solids (rigid shapes) of a device to its body type. The function DeviceKind::body of the kind
/// returns the solids; without it, the call has no effect. Solids that no joint moves are added to the part
/// that carries the device. For each joint that moves solids, a new part with these solids is added. The new
/// part is mounted on the part that carries the device, and has the same properties as that part, such as the
/// colour, but a name of its own. If DeviceKind::body throws an exception, this function throws
/// std::runtime_error and leaves the type unchanged. `device` is the index of the device in type.devices.
/// Call this once for a device, after add_device().
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
