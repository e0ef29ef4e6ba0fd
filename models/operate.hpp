#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Open-loop operation of devices: orders at given times, each of which holds until the next one for the same
/// device. Of a gripper: open, close, up, down; of an actuator: go_to (m or rad), speed (m/s or rad/s).
/// A body that cannot drive can have it, too.
engine::ControllerKind operate_controller();

}  // namespace troupe::models
