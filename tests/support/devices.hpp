#pragma once

#include "engine/add_device.hpp"
#include "models/devices/actuator.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/scene.hpp"

#include <string>
#include <vector>

/// Types with joints, built by hand.
namespace troupe::test {

/// Adds a device with its joints, and the body of its kind.
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

/// An actuator that moves these solids, which are given in its frame.
inline std::size_t add_arm(engine::TypeSpec& type, std::string name, const Pose& pose,
                           std::vector<Solid> solids,
                           std::initializer_list<std::pair<std::string_view, engine::Value>> values) {
  const std::size_t d = add_device(type, std::move(name), "actuator", pose, values);
  engine::PartSpec part{.name = type.devices[d].name, .kind = "actuator", .joint = type.devices[d].moves};
  for (Solid& solid : solids) part.solids.push_back(placed(std::move(solid), pose));
  type.parts.push_back(std::move(part));
  return d;
}

/// An order of the controller "operate".
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

template <class State>
const State& state_of(const engine::World& world, BodyId body, std::size_t device) {
  const Row row = world.row(body);
  return world.percepts(world.type(row).devices[device]).as<State>(world.slot(row));
}

}  // namespace troupe::test
