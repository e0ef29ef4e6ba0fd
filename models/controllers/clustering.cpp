#include "models/controllers/clustering.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/drive_period.hpp"
#include "models/controllers/scan_ahead.hpp"

#include <algorithm>

namespace troupe::models {
namespace {

constexpr double k_turn = 1.0;              // rad/s
constexpr std::uint32_t k_surely_goes = 3;  // least number of decisions until a robot may count as stuck

enum Does : std::uint8_t { k_ahead, k_back, k_turns };

struct Clustering {
  struct Params {
    double speed = 0.15;
    double back = 1;
    double min_front = 0.25;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "speed forward and backward");
      d.member<&Params::back>("back", seconds, within(0, 1e6),
                              "how long the robot drives backwards from a load that it cannot push");
      describe_min_front(d);
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    double x = 0;                    ///< estimated x at the last decision, m
    double y = 0;                    ///< estimated y at the last decision, m
    double heading = 0;              ///< estimated heading at the last decision, rad
    std::uint32_t same_updates = 0;  ///< decisions since `does` last changed
    std::uint8_t does = 0;           ///< what the robot does, one of Does
    std::uint32_t back_updates = 0;  ///< decisions that remain of driving backwards
    std::uint32_t turn_updates = 0;  ///< decisions that remain of the present turn
    float turn = 0;                  ///< turn rate of the present turn, rad/s
    TROUPE_FIELDS(x, y, heading, same_updates, does, back_updates, turn_updates, turn)
  };

  Params params;
  Scanner scanner;
  std::uint64_t period = 1;  // ticks between two runs of the drive, which bind_world() sets

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const Result<Scanner> taken = choice.take_scanner(4);
    if (!taken) return taken.error();
    scanner = *taken;
    return choice.chosen();
  }

  Result<> bind_world(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
    period = drive_period(world, type, part);
    return {};
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const Pose& here = percept.estimate;
    const bool stands = here.x == memory.x && here.y == memory.y && here.heading == memory.heading;
    memory.x = here.x;
    memory.y = here.y;
    memory.heading = here.heading;
    const bool is_stuck =
        stands && memory.same_updates >= std::max(k_surely_goes, decisions_to_move(period, percept));
    const ScanAhead seen = scanner.ahead(percept.ranges(0), params.min_front, 0);
    if (is_stuck && memory.does == k_back) {
      memory.back_updates = 0;  // the robot cannot back off either, so it turns at once
    } else if (is_stuck) {
      memory.back_updates = whole_decisions(params.back, percept.period_s);
      begin_turn(memory, percept, random, random.below(2) == 0 ? -1 : 1);
    } else if (memory.does == k_ahead && seen.obstruction) {
      begin_turn(memory, percept, random, seen.left < seen.right ? -1 : 1);
    }
    const std::uint8_t did = memory.does;
    if (memory.back_updates > 0) {
      --memory.back_updates;
      memory.does = k_back;
      actions.set_speed(-params.speed, 0, 0);
    } else if (memory.turn_updates > 0) {
      --memory.turn_updates;
      memory.does = k_turns;
      actions.set_speed(0, 0, memory.turn);
    } else {
      memory.does = k_ahead;
      actions.set_speed(params.speed, 0, 0);
    }
    memory.same_updates = memory.does == did ? memory.same_updates + 1 : 0;
  }

  static void begin_turn(Memory& memory, const engine::Percept& percept, Random& random, int side) {
    memory.turn = static_cast<float>(side * k_turn);
    memory.turn_updates = 1 + whole_decisions(random.uniform(0, k_pi / k_turn), percept.period_s);
  }

  void lint(const engine::LintView& view) const { warns_of_turning(view, scanner, params.min_front); }
};

}  // namespace

engine::ControllerKind clustering_controller() {
  return engine::make_controller_kind<Clustering>(
      "clustering",
      "push pucks together: drive until the pucks ahead are too many to push, then back off and turn");
}

}  // namespace troupe::models
