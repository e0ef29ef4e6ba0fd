#include "models/controllers/script.hpp"

#include "engine/kinds/controller.hpp"
#include "engine/spec/ticks.hpp"
#include "models/controllers/drive_period.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace troupe::models {
namespace {

enum class Law : std::uint8_t { timed, wave, line };
constexpr std::array<std::string_view, 3> names_of(Law) { return {"timed", "wave", "line"}; }

struct Leg {
  double until_s = 0;
  double forward = 0;
  double left = 0;
  double turn = 0;

  static constexpr void describe(engine::Description<Leg>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&Leg::until_s>("until", seconds, required, at_least(0),
                            "simulated time at which this leg ends and the next one begins");
    d.member<&Leg::forward>("forward", meters_per_second, "forward speed");
    d.member<&Leg::left>("left", meters_per_second, "speed to the left; only omni drives obey it");
    d.member<&Leg::turn>("turn", radians_per_second, "turn rate; for a car drive, the steering angle in rad");
  }
};

struct Script {
  struct Memory {
    std::uint32_t updates = 0;  ///< calls of the controller so far: n in the formulas of script.hpp
    TROUPE_FIELDS(updates)
  };
  struct Params {
    Law law = Law::timed;
    std::vector<Leg> legs;

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::law>("law",
                             "how the robot drives. timed: at the speeds in `legs`; line: straight ahead at "
                             "0.5 m/s; wave: at a forward speed and a turn rate that change every few "
                             "decisions");
      d.member<&Params::legs>("legs",
                              "for the law `timed`: periods with constant speeds, one after another; after "
                              "the last one the robot stands still");
    }
  };

  Params params;
  std::uint64_t period = 1;  // ticks between two runs of the drive, which bind_world() sets

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) const {
    for (std::size_t i = 1; i < params.legs.size(); ++i)
      if (params.legs[i].until_s <= params.legs[i - 1].until_s)
        return Error{
            fmt::format("has a leg with an `until` of {:g} s after a leg with {:g} s: times must increase",
                        params.legs[i].until_s, params.legs[i - 1].until_s)};
    if (params.law == Law::timed && params.legs.empty()) return Error{"needs `legs` for the law `timed`"};
    return std::vector<std::size_t>();
  }

  Result<> bind_world(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
    period = drive_period(world, type, part);
    return {};
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random&, engine::Actions& actions) const {
    const std::int64_t n = ++memory.updates;
    switch (params.law) {
      case Law::wave:
        actions.command = {0.2 + 0.1 * static_cast<double>((n / 7) % 3), 0,
                           0.4 * static_cast<double>((n / 11) % 5 - 2)};
        break;
      case Law::line: actions.command = {0.5, 0, 0}; break;
      case Law::timed: drive_leg(percept, actions); break;
    }
  }

  void drive_leg(const engine::Percept& percept, engine::Actions& actions) const {
    // A command given now acts after the tick `before`, for `period` ticks. It is that of the leg to which
    // the middle of this time belongs: a leg then ends at the run of the drive that is nearest to its time.
    const std::uint64_t before = percept.tick - 1 + period;
    for (const Leg& leg : params.legs)
      if (before + period / 2 < engine::ticks_until(leg.until_s, percept.tick_s))
        return actions.set_speed(leg.forward, leg.left, leg.turn);
    actions.command = {};
  }
};

}  // namespace

engine::ControllerKind script_controller() {
  return engine::make_controller_kind<Script>(
      "script", "drive without sensors, at given speeds for given times or by a fixed law");
}

}  // namespace troupe::models
