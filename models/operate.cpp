#include "models/operate.hpp"

#include "base/diagnostics.hpp"
#include "engine/controller.hpp"
#include "engine/ticks.hpp"
#include "models/actuator.hpp"
#include "models/gripper.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::models {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;

enum class Order { open, close, up, down, go_to, speed };
const std::vector<std::string_view> k_orders{"open", "close", "up", "down", "go_to", "speed"};

const FieldTable& order_fields() {
  static const FieldTable table{{
      {.name = "at", .unit = Unit::seconds, .min = 0, .text = "world time from which the order holds"},
      {.name = "device", .type = FieldType::text, .text = "name of the device"},
      {.name = "order",
       .type = FieldType::text,
       .text = "a gripper's: open, close, up, down; an actuator's: go_to, speed",
       .choices = k_orders},
      {.name = "value",
       .fallback = 0.0,
       .min = -1e6,
       .max = 1e6,
       .text = "of go_to, m or rad; of speed, m/s or rad/s"},
  }};
  return table;
}

struct Operate {
  struct Step {
    double at_s;
    std::string device;
    Order order;
    double value;
    std::size_t chosen = 0;  // position of the device among those of the controller
  };
  std::vector<Step> steps;

  static Operate make(const Record& p) {
    Operate operate;
    for (const Record& r : p[0].records())
      operate.steps.push_back(
          {r[0].number(), r[1].text(),
           static_cast<Order>(std::ranges::find(k_orders, r[2].text()) - k_orders.begin()), r[3].number()});
    std::ranges::stable_sort(operate.steps, {}, &Step::at_s);
    return operate;
  }

  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo> devices, std::vector<bool>&,
                                  std::string& fault) {
    std::vector<std::size_t> chosen;
    for (Step& step : steps) {
      const auto device = std::ranges::find(devices, step.device, &engine::DeviceInfo::name);
      if (device == devices.end()) {
        std::vector<std::string_view> names;
        for (const engine::DeviceInfo& other : devices) names.push_back(other.name);
        fault = fmt::format("has an order for {}", unknown_name("device", step.device, names));
        return {};
      }
      const bool is_gripping = step.order < Order::go_to;
      const std::string_view wanted = is_gripping ? "gripper" : "actuator";
      if (device->kind != wanted) {
        fault = fmt::format("has an order \"{}\" for \"{}\", which is no {}",
                            k_orders[static_cast<std::size_t>(step.order)], step.device, wanted);
        return {};
      }
      const auto index = static_cast<std::size_t>(device - devices.begin());
      const auto known = std::ranges::find(chosen, index);
      step.chosen = static_cast<std::size_t>(known - chosen.begin());
      if (known == chosen.end()) chosen.push_back(index);
    }
    if (steps.empty()) fault = "needs orders: it does nothing without them";
    return chosen;
  }

  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    for (const Step& step : steps) {  // in the order of time: the last that has begun holds
      if (percept.tick < engine::ticks_until(step.at_s, percept.tick_s)) return;
      using G = GripperCommand;
      switch (step.order) {
        case Order::open: actions.device<G>(step.chosen).order = G::open; break;
        case Order::close: actions.device<G>(step.chosen).order = G::close; break;
        case Order::up: actions.device<G>(step.chosen).order = G::up; break;
        case Order::down: actions.device<G>(step.chosen).order = G::down; break;
        case Order::go_to:
          actions.device<ActuatorCommand>(step.chosen) = {ActuatorCommand::position, step.value};
          break;
        case Order::speed:
          actions.device<ActuatorCommand>(step.chosen) = {ActuatorCommand::velocity, step.value};
          break;
      }
    }
  }
  static constexpr bool needs_drive = false;
};

}  // namespace

engine::ControllerKind operate_controller() {
  static const FieldTable fields{{
      {.name = "orders",
       .type = FieldType::records,
       .fallback = std::vector<Record>{},
       .text = "what is asked of which device, and when",
       .record = &order_fields()},
  }};
  return engine::make_controller_kind<Operate>("operate", "operate grippers and actuators by timed orders",
                                               fields);
}

}  // namespace troupe::models
