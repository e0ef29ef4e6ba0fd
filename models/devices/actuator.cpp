#include "models/devices/actuator.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;

enum class ActuatorType : std::uint8_t { linear, rotational };
constexpr std::array<std::string_view, 2> names_of(ActuatorType) { return {"linear", "rotational"}; }

struct Actuator {
  struct Params {
    ActuatorType type = ActuatorType::linear;
    Eigen::Vector3d axis{1, 0, 0};
    double min_position = 0;
    double max_position = 1;
    double max_speed = 1;
    double start_position = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      constexpr double k_far = 1e6;
      d.member<&Params::type>(
          "type", "linear: the joint slides along `axis`; rotational: it turns about a vertical axis");
      d.member<&Params::axis>("axis", within(-k_far, k_far),
                              "direction in which a linear actuator slides, [x, y, z] in the frame of the "
                              "actuator; [0, 0, 0] means the x axis");
      d.member<&Params::min_position>("min_position", within(-k_far, k_far),
                                      "lower limit of the position, m if linear, rad if rotational");
      d.member<&Params::max_position>("max_position", within(-k_far, k_far),
                                      "upper limit of the position, m if linear, rad if rotational");
      d.member<&Params::max_speed>("max_speed", within(0, k_far),
                                   "greatest speed, m/s if linear, rad/s if rotational");
      d.member<&Params::start_position>(
          "start_position", within(-k_far, k_far),
          "position at the start, m if linear, rad if rotational; clamped to the limits");
    }
  };
  using State = ActuatorState;
  using Command = ActuatorCommand;
  static constexpr std::array joints{std::string_view("joint")};

  bool rotational = false;
  Eigen::Vector3d axis{1, 0, 0};  // unit vector, frame of the joint
  double min = 0;
  double max = 1;
  double max_speed = 1;
  double start_position = 0;
  Result<> range;  // holds an error if min_position exceeds max_position; bind_part() returns it

  static Actuator read(const Params& params) {
    Actuator actuator;
    actuator.rotational = params.type == ActuatorType::rotational;
    const Eigen::Vector3d& axis = params.axis;
    const double length = sqrt(axis.x() * axis.x() + axis.y() * axis.y() + axis.z() * axis.z());
    if (length > 0) actuator.axis = axis / length;
    actuator.min = params.min_position;
    actuator.max = std::max(params.min_position, params.max_position);
    if (params.max_position < params.min_position)
      actuator.range = Error{fmt::format("has a \"min_position\" of {}, above its \"max_position\" of {}",
                                         params.min_position, params.max_position)};
    actuator.max_speed = params.max_speed;
    actuator.start_position = std::clamp(params.start_position, actuator.min, actuator.max);
    return actuator;
  }
  static DeviceKind::Prepared prepare(const Params& params, const Pose&) {
    const Actuator actuator = read(params);
    return {.data = actuator,
            .watts = 2,  // as in Stage
            .joints = {actuator.at(actuator.start_position)},
            .joint_reach_m = actuator.reach()};
  }
  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) const { return range; }
  void start(State& row) const { row.position = start_position; }

  Pose at(double position) const {
    if (rotational) return {0, 0, 0, position};
    return {position * axis.x(), position * axis.y(), position * axis.z(), 0};
  }
  /// Greatest horizontal distance that the joint itself moves from its pose in the world file, m; 0 if it
  /// only turns.
  double reach() const {
    return rotational ? 0 : axis.head<2>().norm() * std::max(std::abs(min), std::abs(max));
  }
  /// The position that the command asks for, m or rad, at most max_speed * period_s from the present
  /// position. period_s: time since the actuator last ran, s.
  double next(const Command& command, double position, double period_s) const {
    double goal = std::clamp(position, min, max);
    if (command.mode == Command::position)
      goal = std::clamp(command.goal, min, max);
    else if (goal == position)
      return std::clamp(position + std::clamp(command.goal, -max_speed, max_speed) * period_s, min, max);
    // In velocity mode, the joint is outside its limits here, because a setting has changed them.
    const double most = max_speed * period_s;
    if (std::abs(goal - position) <= most) return goal;
    return position + std::clamp(goal - position, -most, most);
  }

  void act(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      auto& state = batch.state.as<ActuatorState>(batch.slot(i));
      const auto& command = batch.commands->as<ActuatorCommand>(batch.slot(i));
      if (std::isnan(command.goal))
        throw engine::StepError(
            fmt::format("tick {}: an actuator of \"{}\" was commanded a {} that is not a number",
                        batch.view.tick(), batch.view.spec().name(batch.body(i)),
                        command.mode == Command::position ? "position" : "velocity"));
      const double to = next(command, state.position, batch.period_s);
      state.velocity = 0;
      state.stalled = 0;
      state.asked = to;
      if (to == state.position) continue;
      state.velocity = (to - state.position) / batch.period_s;
      batch.move_joint(i, 0, at(to));
    }
  }

  void joints_moved(const DeviceBatch& batch) const {
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
};

}  // namespace

DeviceKind actuator_kind() {
  return engine::make_device_kind<Actuator>("actuator", "a joint that moves the parts mounted on it");
}

}  // namespace troupe::models
