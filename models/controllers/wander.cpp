#include "models/controllers/wander.hpp"

#include "engine/kinds/controller.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"

namespace troupe::models {
namespace {

struct Wander {
  struct Params {
    double cruise_speed = 0.4;
    double avoid_speed = 0.05;
    double avoid_turn = 0.5;
    double min_front = 1;
    double stop = 0.3;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::cruise_speed>("cruise_speed", meters_per_second, "speed while the way is clear");
      d.member<&Params::avoid_speed>("avoid_speed", meters_per_second, "forward speed while turning away");
      d.member<&Params::avoid_turn>("avoid_turn", radians_per_second, "turn rate while turning away");
      d.member<&Params::min_front>(
          "min_front", meters, at_least(0),
          "the robot turns away when a reading in the middle third of the scan is below this");
      d.member<&Params::stop>("stop", meters, at_least(0),
                              "the robot turns on the spot when a reading in the middle third of the scan is "
                              "below this");
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::int32_t avoid_updates = 0;  ///< decisions that remain of the present turn
    TROUPE_FIELDS(avoid_updates)
  };

  Params params;
  Scanner scanner;

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const Result<Scanner> taken = choice.take_scanner(3);
    if (!taken) return taken.error();
    scanner = *taken;
    return choice.chosen();
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const auto [obstruction, stop, left, right] =
        scanner.ahead(percept.ranges(0), params.min_front, params.stop);
    // A program may have commanded another control mode between two ticks.
    actions.command.mode = engine::ControlMode::velocity;
    if (!obstruction && !stop && memory.avoid_updates == 0) {
      actions.command = {params.cruise_speed, 0, 0};
      return;
    }
    actions.command.x = stop ? 0 : params.avoid_speed;
    if (memory.avoid_updates < 1) {
      memory.avoid_updates = 10 + static_cast<std::int32_t>(random.below(10));
      actions.command.turn = left < right ? -params.avoid_turn : params.avoid_turn;
    }
    --memory.avoid_updates;
  }

  void lint(const engine::LintView& view) const {
    if (!warns_of_turning(view, scanner, params.min_front))
      warns_of_turning(view, scanner, params.stop, "stop");
  }
};

}  // namespace

engine::ControllerKind wander_controller() {
  return engine::make_controller_kind<Wander>(
      "wander", "drive about, and turn away from obstacles that the ranger sees ahead");
}

}  // namespace troupe::models
