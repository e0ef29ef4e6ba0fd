#include "models/devices/actuator.hpp"

#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Record;

struct Actuator {
  bool rotational = false;
  Eigen::Vector3d axis{1, 0, 0};  // of length 1, frame of the joint
  double min = 0;
  double max = 1;
  double max_speed = 1;
  double start = 0;
  Result<> range;  // whether its ends are in order

  Pose at(double position) const {
    if (rotational) return {0, 0, 0, position};
    return {position * axis.x(), position * axis.y(), position * axis.z(), 0};
  }
  /// How far it moves anything to the side, m.
  double reach() const {
    return rotational ? 0 : axis.head<2>().norm() * std::max(std::abs(min), std::abs(max));
  }
  /// m/s or rad/s, for the tick that follows.
  double speed(const ActuatorCommand& command, double position, double period_s) const {
    double wanted = command.goal;
    if (command.mode == ActuatorCommand::position)
      wanted = (std::clamp(command.goal, min, max) - position) / period_s;
    return std::clamp(wanted, -max_speed, max_speed);
  }
};

Actuator read(const Record& params) {
  Actuator actuator;
  actuator.rotational = params[0].text() == "rotational";
  const std::vector<double>& axis = params[1].numbers();
  const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  if (length > 0) actuator.axis = Eigen::Vector3d(axis[0], axis[1], axis[2]) / length;
  actuator.min = params[2].number();
  actuator.max = std::max(actuator.min, params[3].number());
  if (params[3].number() < actuator.min)
    actuator.range =
        Error{fmt::format("needs a \"min_position\", here {}, of at most its \"max_position\", here {}",
                          actuator.min, params[3].number())};
  actuator.max_speed = params[4].number();
  actuator.start = std::clamp(params[5].number(), actuator.min, actuator.max);
  return actuator;
}

void act(const DeviceBatch& batch) {
  const Actuator& actuator = *std::any_cast<Actuator>(&batch.data);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    auto& state = batch.state.as<ActuatorState>(batch.slot(i));
    const double speed =
        actuator.speed(batch.commands->as<ActuatorCommand>(batch.slot(i)), state.position, batch.period_s);
    const double to = std::clamp(state.position + speed * batch.period_s, actuator.min, actuator.max);
    state.velocity = 0;
    state.stalled = 0;
    state.asked = to;
    if (to == state.position) continue;
    state.velocity = (to - state.position) / batch.period_s;
    batch.move_joint(i, 0, actuator.at(to));
  }
}

void settled(const DeviceBatch& batch) {
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    if (!batch.asked_joint(i, 0)) continue;
    auto& state = batch.state.as<ActuatorState>(batch.slot(i));
    if (batch.moved_joint(i, 0)) {
      state.position = state.asked;
    } else {
      state.velocity = 0;
      state.stalled = 1;
    }
  }
}

}  // namespace

DeviceKind actuator_kind() {
  DeviceKind kind{.name = "actuator", .text = "a joint that moves what stands on it"};
  kind.params = {{
      {.name = "type",
       .type = FieldType::text,
       .fallback = std::string("linear"),
       .text = "along an axis, or about a vertical one",
       .choices = {"linear", "rotational"}},
      {.name = "axis",
       .type = FieldType::numbers,
       .fallback = std::vector<double>{1, 0, 0},
       .min = -1e6,
       .max = 1e6,
       .text = "direction of a linear one, [x, y, z] in its own frame; of no length: x",
       .columns = 3},
      {.name = "min_position", .fallback = 0.0, .min = -1e6, .max = 1e6, .text = "limit, m or rad"},
      {.name = "max_position", .fallback = 1.0, .min = -1e6, .max = 1e6, .text = "limit, m or rad"},
      {.name = "max_speed", .fallback = 1.0, .min = 0, .max = 1e6, .text = "m/s or rad/s"},
      {.name = "start_position",
       .fallback = 0.0,
       .min = -1e6,
       .max = 1e6,
       .text = "at the start, m or rad, kept within the limits"},
  }};
  kind.joints = {"joint"};
  kind.prepare = [](const Record& params, const Pose&) {
    const Actuator actuator = read(params);
    return DeviceKind::Prepared{.data = actuator,
                                .percepts = engine::memory_fields<ActuatorState>(),
                                .percept_bytes = sizeof(ActuatorState),
                                .commands = engine::memory_fields<ActuatorCommand>(),
                                .command_bytes = sizeof(ActuatorCommand),
                                .watts = 2,  // as in Stage
                                .joints = {actuator.at(actuator.start)},
                                .joint_reach_m = actuator.reach()};
  };
  kind.mount = [](std::any& data, const engine::TypeSpec&, std::uint32_t) {
    return std::any_cast<Actuator>(&data)->range;
  };
  kind.start = [](const std::any& data, engine::StateTable& state, std::size_t slot) {
    state.as<ActuatorState>(slot).position = std::any_cast<Actuator>(&data)->start;
  };
  kind.act = act;
  kind.settled = settled;
  return kind;
}

}  // namespace troupe::models
