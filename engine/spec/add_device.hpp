#pragma once

#include "engine/kinds/device_kind.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::engine {

/// Adds a device (a sensor or an actuator) to a body type, together with the joints that the device moves.
/// Returns the index of the device in type.devices.
///
/// type: the description that all bodies of the same construction share
/// device: the device; its members `part`, `joint` and `pose_body_device` must say where it is mounted
/// kind: the kind that device.kind names: the table of functions that implements the device. Its member
/// DeviceKind::joints lists the joints.
///
/// Each new joint is mounted on the joint device.joint, and has the rest pose device.pose_body_device (body
/// frame). The function sets the member `moves` of the added device to the index of the first new joint, if
/// there is one.
///
/// If the kind has one joint, the joint has the name of the device or, if this name is empty, the name of the
/// kind. If the kind has several joints, `/` and the name of the joint in DeviceKind::joints are appended to
/// this name. If the type already has a joint of the resulting name, `#2` (or `#3`, ...) is appended.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind);
/// As the function above, but faster for a type with many joints. `joint_names` must have the mark
/// k_device_mark and contain the names of all joints of the type; the function adds those of the new joints.
std::size_t add_device(TypeSpec& type, DeviceSpec device, const DeviceKind& kind, UniqueNames& joint_names);

/// Adds the solids (rigid shapes) of a device to its body type. Call this once for each device, after
/// add_device(). `device` is the index of the device in type.devices.
///
/// The function DeviceKind::body of the kind returns the solids. If the kind has no such function, the call
/// has no effect. Solids that no joint moves are added to the part that carries the device. For each joint
/// that moves solids, a new part with these solids is added to the type. The new part is mounted on the part
/// that carries the device, and has a new name. Its other properties, such as the colour, are copied from the
/// part that carries the device.
///
/// If DeviceKind::body throws, or returns a solid on a joint that the kind does not have, this function
/// throws std::runtime_error and leaves the type unchanged.
void add_device_body(TypeSpec& type, std::size_t device, const DeviceKind& kind);

}  // namespace troupe::engine
