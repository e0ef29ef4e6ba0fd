#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Open-loop operation of devices: orders at given times, each of which holds until the next one for the same
/// device. Of a gripper: open, close, up, down; of an actuator: go_to (m or rad), speed (m/s or rad/s).
/// A body that cannot drive can have it, too. In a .world file the orders are one word:
/// `ctrl "operate hand:close@2,arm:go_to:0.5@3.5"`; of a device that is its body's root the name is empty.
engine::ControllerKind operate_controller();

}  // namespace troupe::models
