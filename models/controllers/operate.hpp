#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `operate`: it gives grippers and actuators (motor-driven joints)
/// fixed orders at fixed times. It reads no sensors. Bodies without a drive can also have it.
///
/// orders  Each order has a time (simulated time, s) and the name of a device. Orders for a gripper: open,
///         close, up, down. Orders for an actuator: go_to with a position (m or rad), speed with a speed (m/s
///         or rad/s).
/// when    The controller gives an order in its first call at or after the time of the order. The order holds
///         until the next order for the same device.
/// .world  In a .world file (Stage's format), all orders are one word.
///         `ctrl "operate hand:close@2,arm:go_to:0.5@3.5"` closes the gripper `hand` at 2 s and moves the
///         actuator `arm` to 0.5 m (or rad) from 3.5 s on. A device that is the main part of its body, not
///         mounted on another part, has an empty name, as in `:close@2`.
engine::ControllerKind operate_controller();

}  // namespace troupe::models
