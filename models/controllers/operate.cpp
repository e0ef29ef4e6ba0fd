#include "models/controllers/operate.hpp"

#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/spec/ticks.hpp"
#include "models/devices/actuator.hpp"
#include "models/devices/gripper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace troupe::models {
namespace {

enum class Order : std::uint8_t { open, close, up, down, go_to, speed };
constexpr std::array<std::string_view, 6> names_of(Order) {
  return {"open", "close", "up", "down", "go_to", "speed"};
}
constexpr std::array k_orders = names_of(Order{});

struct Step {
  double at_s = 0;
  std::string device;
  Order order = Order::open;
  double value = 0;
  std::size_t chosen = 0;  // index of the device among the chosen devices

  static constexpr void describe(engine::Description<Step>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&Step::at_s>(
        "at", seconds, required, at_least(0),
        "simulated time from which the order holds, until the next order for the same device");
    d.member<&Step::device>("device", required, "name of the device");
    d.member<&Step::order>(
        "order", required,
        "what the device does. A gripper: open, close, up, down; an actuator: go_to, speed");
    d.member<&Step::value>("value", within(-1e6, 1e6),
                           "for go_to: the position, m or rad; for speed: the speed, m/s or rad/s");
    d.derived<&Step::chosen>();
  }
};

bool takes_value(Order order) { return order >= Order::go_to; }

std::optional<double> value_of(std::string_view text) {
  const std::optional<double> number = finite_number_of(text);
  return number && std::abs(*number) <= 1e6 ? number : std::nullopt;
}

/// Returns the text of `rest` before the first separator, and removes this text and the separator from
/// `rest`. If there is no separator, returns all of `rest` and leaves it empty.
std::string_view take_first(char separator, std::string_view& rest) {
  const std::size_t end = std::min(rest.size(), rest.find(separator));
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(std::min(rest.size(), end + 1));
  return word;
}
/// Returns the text of `rest` after the last colon, and removes this text and the colon from `rest`. If there
/// is no colon, returns all of `rest` and leaves it empty.
std::string_view take_last(std::string_view& rest) {
  const std::size_t colon = rest.rfind(':');
  const std::string_view word = colon == rest.npos ? rest : rest.substr(colon + 1);
  rest = colon == rest.npos ? std::string_view() : rest.substr(0, colon);
  return word;
}

/// Reads one entry of a plan: DEVICE:ORDER@SECONDS or DEVICE:ORDER:VALUE@SECONDS. The name of the device may
/// contain colons.
Result<Step> read_step(std::string_view entry) {
  std::string_view time = entry;
  std::string_view device = take_first('@', time);
  const std::optional<double> at_s = value_of(time);
  const bool has_colon = device.find(':') != device.npos;
  std::string_view name = take_last(device);
  std::string_view number;
  const auto is_order = [](std::string_view word) {
    return std::ranges::find(k_orders, word) != k_orders.end();
  };
  if (!is_order(name) && value_of(name)) {
    number = name;
    name = take_last(device);
  }
  const std::optional<double> value = value_of(number);
  if (!at_s || *at_s < 0 || !has_colon)
    return Error{fmt::format(
        "has a plan with \"{}\", which is not DEVICE:ORDER@SECONDS or DEVICE:ORDER:VALUE@SECONDS", entry)};
  if (!is_order(name))
    return Error{fmt::format("has a plan with an {}",
                             unknown_name("order", name, {k_orders.begin(), k_orders.end()}))};
  const auto order = static_cast<Order>(std::ranges::find(k_orders, name) - k_orders.begin());
  if (takes_value(order) != value.has_value())
    return Error{fmt::format("has a plan with \"{}\", whose order {}", entry,
                             takes_value(order) ? "needs a value: write DEVICE:ORDER:VALUE@SECONDS"
                                                : "takes no value: write DEVICE:ORDER@SECONDS")};
  return Step{*at_s, std::string(device), order, value.value_or(0)};
}

struct Operate {
  struct Params {
    std::string plan;
    std::vector<Step> orders;

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::plan>("plan",
                              "orders as one word, for .world files: DEVICE:ORDER@SECONDS or "
                              "DEVICE:ORDER:VALUE@SECONDS, separated by commas");
      d.member<&Params::orders>("orders", "orders to grippers and actuators, each with its simulated time");
    }
  };

  std::vector<Step> steps;
  Result<> readable;  // an error if the plan cannot be read; choose() returns this error

  static Operate make(const Params& params) {
    Operate operate;
    for (std::string_view plan = params.plan; !plan.empty() && operate.readable;)
      if (const Result<Step> step = read_step(take_first(',', plan)))
        operate.steps.push_back(*step);
      else
        operate.readable = step.error();
    operate.steps.insert(operate.steps.end(), params.orders.begin(), params.orders.end());
    std::ranges::stable_sort(operate.steps, {}, &Step::at_s);
    return operate;
  }

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices, std::vector<bool>&) {
    if (!readable) return readable.error();
    std::vector<std::size_t> chosen;
    for (Step& step : steps) {
      const auto device = std::ranges::find(devices, step.device, &engine::DeviceInfo::name);
      if (device == devices.end())
        return Error{
            fmt::format("has an order for the {}", unknown_name("device", step.device, name_list(devices)))};
      const std::string_view wanted = takes_value(step.order) ? "actuator" : "gripper";
      if (device->kind != wanted)
        return Error{fmt::format(
            "has an order \"{}\" for \"{}\", which is of kind \"{}\": only devices of kind \"{}\" "
            "take this order",
            k_orders[static_cast<std::size_t>(step.order)], step.device, device->kind, wanted)};
      if (!takes_value(step.order) && step.value != 0)
        return Error{
            fmt::format("has an order \"{}\" for \"{}\" with the value {:g}: this order takes no value",
                        k_orders[static_cast<std::size_t>(step.order)], step.device, step.value)};
      const auto index = static_cast<std::size_t>(device - devices.begin());
      const auto known = std::ranges::find(chosen, index);
      step.chosen = static_cast<std::size_t>(known - chosen.begin());
      if (known == chosen.end()) chosen.push_back(index);
    }
    if (steps.empty()) return Error{"has no orders: give `orders` (in a .world file: `plan`)"};
    return chosen;
  }

  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    // The steps are in order of time, so the last order for a device whose time has come prevails.
    for (const Step& step : steps) {
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
  return engine::make_controller_kind<Operate>("operate", "operate grippers and actuators at given times");
}

}  // namespace troupe::models
