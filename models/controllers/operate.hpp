#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Open-loop operation of devices by orders at given times. An order holds until the next one for the same
/// device. Orders for a gripper: open, close, up, down; for an actuator: go_to (m or rad), speed (m/s or
/// rad/s). Bodies without a drive can have it too. In a .world file the orders are one word:
/// `ctrl "operate hand:close@2,arm:go_to:0.5@3.5"`. A device that is the root of its body has an empty name.
engine::ControllerKind operate_controller();

}  // namespace troupe::models
