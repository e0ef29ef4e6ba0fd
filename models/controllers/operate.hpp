#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `operate`: open-loop operation of grippers and actuators
/// (motor-driven joints) by orders at given simulated times, s. An order holds from the first call of the
/// controller at or after its time until the next order for the same device. The orders for a gripper are
/// open, close, up and down. The orders for an actuator are go_to (a position, m or rad) and speed (m/s or
/// rad/s). Bodies without a drive can also have this controller. In a .world file (Stage's format) all orders
/// are one word: `ctrl "operate hand:close@2,arm:go_to:0.5@3.5"` closes the gripper `hand` at 2 s and moves
/// the actuator `arm` to 0.5 m or rad from 3.5 s on. A device that is the main part of its body, not mounted
/// on another part, has an empty name, as in `:close@2`.
engine::ControllerKind operate_controller();

}  // namespace troupe::models
