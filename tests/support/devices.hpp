#pragma once

#include "engine/spec/add_device.hpp"
#include "models/devices/actuator.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/scene.hpp"

#include <any>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

/// Functions for tests. They add devices with joints to body types, and make controllers that operate devices
/// or drive robots.
namespace troupe::test {

/// Adds a device of the kind `kind_name` to a body type. Also adds the joints and solids that devices of this
/// kind have. pose: pose of the device in the body frame. values: names and values of parameters; all other
/// parameters have their defaults. Returns the index of the device in type.devices.
inline std::size_t add_device(engine::TypeSpec& type, std::string name, std::string kind_name,
                              const Pose& pose,
                              std::initializer_list<std::pair<std::string_view, engine::Value>> values = {}) {
  const engine::DeviceKind& kind = *registry().device(kind_name);
  engine::DeviceSpec device{.name = std::move(name),
                            .kind = kind_name,
                            .params = record(kind.params, values),
                            .pose_body_device = pose};
  const std::size_t d = engine::add_device(type, std::move(device), kind);
  engine::add_device_body(type, d, kind);
  return d;
}

/// A kind of device, "moody", which cannot start while `throws` is true.
struct Moody {
  static inline bool throws = false;
  static engine::DeviceKind kind() {
    engine::DeviceKind made{.name = "moody", .text = ""};
    made.prepare = [](const engine::Record&, const Pose&) { return engine::DeviceKind::Prepared{.data = 0}; };
    made.start = [](const std::any&, engine::StateTable&, std::size_t) {
      if (throws) throw std::runtime_error("not today");
    };
    return made;
  }
};

/// Adds an actuator (a motor-driven joint) that moves `solids`. The solids are given in the frame of the
/// actuator. The other parameters and the result are those of add_device().
inline std::size_t add_arm(engine::TypeSpec& type, std::string name, const Pose& pose,
                           std::vector<Solid> solids,
                           std::initializer_list<std::pair<std::string_view, engine::Value>> values) {
  const std::size_t d = add_device(type, std::move(name), "actuator", pose, values);
  engine::PartSpec part{.name = type.devices[d].name, .kind = "actuator", .joint = type.devices[d].moves};
  for (Solid& solid : solids) part.solids.push_back(placed(std::move(solid), pose));
  type.parts.push_back(std::move(part));
  return d;
}

/// Returns one order for operate(). At the simulated time at_s (s), the controller gives the order `what` to
/// the device. value: the number that some orders need, such as the position (m or rad) of "go_to"; other
/// orders ignore it.
inline engine::Record order(double at_s, std::string device, std::string what, double value = 0) {
  return {at_s, std::move(device), std::move(what), value};
}
inline engine::ControllerSpec operate(std::vector<engine::Record> orders) {
  return controller("operate", {{"orders", std::move(orders)}});
}

/// Returns one leg for drive_legs(): the robot drives with the speeds `forward` (m/s) and `turn` (rad/s)
/// until the simulated time until_s (s).
inline engine::Record leg(double until_s, double forward, double turn = 0) {
  return {until_s, forward, 0.0, turn};
}
inline engine::ControllerSpec drive_legs(std::vector<engine::Record> legs) {
  return controller("script", {{"legs", std::move(legs)}});
}

/// Returns the state of a device of a body. device: index of the device in the devices of the body's type.
/// State: the state struct of the kind of the device.
template <class State>
const State& state_of(const engine::World& world, BodyId body, std::size_t device) {
  const Row row = world.view().row(body);
  return world.tables()[world.view().type(row).devices[device].table].as<State>(world.view().slot(row));
}

}  // namespace troupe::test
