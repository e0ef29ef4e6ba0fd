#pragma once

#include "engine/spec/add_device.hpp"
#include "models/devices/actuator.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/scene.hpp"

#include <string>
#include <vector>

/// Functions that add devices with joints to types, and controllers that move them.
namespace troupe::test {

/// Adds a device of the kind `kind_name` to the type, with its joints and the solids that the kind defines.
/// pose: in the frame of the body; values: parameters that differ from the defaults. Returns the index of the
/// device.
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

/// Adds an actuator that moves `solids`, given in the frame of the actuator. Other arguments and the result:
/// as for add_device().
inline std::size_t add_arm(engine::TypeSpec& type, std::string name, const Pose& pose,
                           std::vector<Solid> solids,
                           std::initializer_list<std::pair<std::string_view, engine::Value>> values) {
  const std::size_t d = add_device(type, std::move(name), "actuator", pose, values);
  engine::PartSpec part{.name = type.devices[d].name, .kind = "actuator", .joint = type.devices[d].moves};
  for (Solid& solid : solids) part.solids.push_back(placed(std::move(solid), pose));
  type.parts.push_back(std::move(part));
  return d;
}

/// Returns an order of the controller "operate": at the world time `at_s`, s, the device gets the order
/// `what`.
inline engine::Record order(double at_s, std::string device, std::string what, double value = 0) {
  return {at_s, std::move(device), std::move(what), value};
}
inline engine::ControllerSpec operate(std::vector<engine::Record> orders) {
  return controller("operate", {{"orders", std::move(orders)}});
}

/// A leg of the controller "script": a speed, m/s, and a turn rate, rad/s, until a time, s.
inline engine::Record leg(double until_s, double forward, double turn = 0) {
  return {until_s, forward, 0.0, turn};
}
inline engine::ControllerSpec drive_legs(std::vector<engine::Record> legs) {
  return controller("script", {{"legs", std::move(legs)}});
}

/// Returns the state of the device with the index `device` in the type of the body.
template <class State>
const State& state_of(const engine::World& world, BodyId body, std::size_t device) {
  const Row row = world.row(body);
  return world.percepts(world.type(row).devices[device]).as<State>(world.slot(row));
}

}  // namespace troupe::test
