#include "models/controllers/wander.hpp"

#include "engine/controller.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"

namespace troupe::models {
namespace {

using engine::FieldTable;
using engine::Record;
using engine::Unit;

const FieldTable& wander_fields() {
  static const FieldTable table{{
      {.name = "cruise_speed", .unit = Unit::meters_per_second, .fallback = 0.4, .text = "with a free way"},
      {.name = "avoid_speed",
       .unit = Unit::meters_per_second,
       .fallback = 0.05,
       .text = "while turning away"},
      {.name = "avoid_turn", .unit = Unit::radians_per_second, .fallback = 0.5, .text = "while turning away"},
      {.name = "min_front",
       .unit = Unit::meters,
       .fallback = 1.0,
       .min = 0,
       .text = "a reading below it in the middle third is an obstruction"},
      {.name = "stop",
       .unit = Unit::meters,
       .fallback = 0.3,
       .min = 0,
       .text = "a reading below it in the middle third stops the robot"},
  }};
  return table;
}

struct Wander {
  struct Memory {
    std::int32_t avoid_updates = 0;  ///< scans for which the present turn still goes on
    TROUPE_FIELDS(avoid_updates)
  };

  double cruise, avoid, turn, min_front, stop_distance;
  Scanner scanner;

  static Wander make(const Record& p) {
    return {p[0].number(), p[1].number(), p[2].number(), p[3].number(), p[4].number()};
  }

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
    const auto [obstruction, stop, left, right] = scanner.look(percept.ranges(0), min_front, stop_distance);
    // Whatever was commanded from outside before, it is speeds from now on.
    actions.command.mode = engine::ControlMode::velocity;
    if (!obstruction && !stop && memory.avoid_updates == 0) {
      actions.command = {cruise, 0, 0};
      return;
    }
    actions.command.x = stop ? 0 : avoid;
    if (memory.avoid_updates < 1) {
      memory.avoid_updates = 10 + static_cast<std::int32_t>(random.below(10));
      actions.command.turn = left < right ? -turn : turn;
    }
    --memory.avoid_updates;
  }
};

}  // namespace

engine::ControllerKind wander_controller() {
  return engine::make_controller_kind<Wander>("wander", "drive about, turning from what a scanner sees ahead",
                                              wander_fields());
}

}  // namespace troupe::models
