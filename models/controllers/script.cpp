#include "models/controllers/script.hpp"

#include "engine/controller.hpp"
#include "engine/ticks.hpp"

namespace troupe::models {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;

const FieldTable& leg_fields() {
  static const FieldTable table{{
      {.name = "until", .unit = Unit::seconds, .min = 0, .text = "world time at which the next leg begins"},
      {.name = "forward", .unit = Unit::meters_per_second, .fallback = 0.0, .text = "speed"},
      {.name = "left", .unit = Unit::meters_per_second, .fallback = 0.0, .text = "speed, omni drives only"},
      {.name = "turn",
       .unit = Unit::radians_per_second,
       .fallback = 0.0,
       .text = "turn rate; for a car the steering angle in rad"},
  }};
  return table;
}

const FieldTable& script_fields() {
  static const FieldTable table{{
      {.name = "law",
       .type = FieldType::text,
       .fallback = "timed",
       .text = "what is driven",
       .choices = {"timed", "wave", "line"}},
      {.name = "legs",
       .type = FieldType::records,
       .fallback = std::vector<Record>{},
       .text = "speeds one after another, for the law `timed`; after the last the robot stands",
       .record = &leg_fields()},
  }};
  return table;
}

struct Script {
  struct Memory {
    std::uint32_t updates = 0;  ///< n of the laws
    TROUPE_FIELDS(updates)
  };
  enum class Law { timed, wave, line };
  struct Leg {
    double until_s;
    engine::Command command;
  };

  Law law;
  std::vector<Leg> legs;

  static Script make(const Record& p) {
    Script script{p[0].text() == "wave" ? Law::wave : p[0].text() == "line" ? Law::line : Law::timed, {}};
    for (const Record& leg : p[1].records())
      script.legs.push_back({leg[0].number(), {leg[1].number(), leg[2].number(), leg[3].number()}});
    return script;
  }

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) const {
    for (std::size_t i = 1; i < legs.size(); ++i)
      if (legs[i].until_s <= legs[i - 1].until_s)
        return Error{"has a leg that ends before it begins: `until` must rise"};
    if (law == Law::timed && legs.empty())
      return Error{"needs legs: the law `timed` drives nothing without them"};
    return std::vector<std::size_t>();
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random&, engine::Actions& actions) const {
    const std::int64_t n = ++memory.updates;
    switch (law) {
      case Law::wave:
        actions.command = {0.2 + 0.1 * static_cast<double>((n / 7) % 3), 0,
                           0.4 * static_cast<double>((n / 11) % 5 - 2)};
        break;
      case Law::line: actions.command = {0.5, 0, 0}; break;
      case Law::timed:
        actions.command = {};
        for (const Leg& leg : legs) {
          if (percept.tick >= engine::ticks_until(leg.until_s, percept.tick_s)) continue;
          actions.command = leg.command;
          break;
        }
        break;
    }
  }
};

}  // namespace

engine::ControllerKind script_controller() {
  return engine::make_controller_kind<Script>("script", "drive open loop by timed speeds or a fixed law",
                                              script_fields());
}

}  // namespace troupe::models
