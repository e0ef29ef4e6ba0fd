#include "models/controllers/beeclust.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/random_turn.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "models/devices/led.hpp"
#include "sensors/ground.hpp"
#include "sensors/radio.hpp"

#include <cmath>

namespace troupe::models {
namespace {

using sensors::k_ground_color;
using sensors::RadioPort;

constexpr double k_ahead = k_pi / 3;  // rad: greatest bearing, to either side, of a robot that it meets

struct Beeclust {
  struct Params {
    double speed = 0.1;
    double max_wait = 60;
    double half = 0.22;
    double meet = 0.12;
    double min_front = 0.08;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "forward speed");
      d.member<&Params::max_wait>("max_wait", seconds, within(0, 1e6),
                                  "limit of the waiting time: on ground of brightness S (0 to 1) a robot "
                                  "waits max_wait S^2 / (S^2 + half)");
      d.member<&Params::half>(
          "half", above(0), at_most(1e6),
          "square of the ground's brightness (0 to 1) at which a robot waits for half of `max_wait`");
      d.member<&Params::meet>(
          "meet", meters, at_least(0),
          "a robot meets another robot that is ahead of it if their radios are at most this far apart");
      describe_min_front(d);
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::uint32_t wait_updates = 0;  ///< decisions that remain of the present wait
    std::uint32_t turn_updates = 0;  ///< decisions that remain of the present turn
    float turn = 0;                  ///< turn rate of the present turn, rad/s
    TROUPE_FIELDS(wait_updates, turn_updates, turn)
  };
  static constexpr std::size_t k_ground = 0, k_radio = 1, k_scanner = 2, k_led = 3;

  Params params;
  double radio_heading = 0;  // heading of the radio in the frame of the drive, rad
  Scanner scanner;
  bool has_led = false;

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const Result<Scanner> taken = choice.take_ground_radio_scanner(4);
    if (!taken) return taken.error();
    scanner = *taken;
    radio_heading = devices[choice.chosen()[k_radio]].pose.heading;
    has_led = choice.take_kind("led");
    return choice.chosen();
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[k_radio], actions.devices[k_radio]);
    radio.say();
    if (memory.wait_updates > 0) {
      // When the wait is over, the robot turns away from the robot that it met.
      if (--memory.wait_updates == 0) begin_turn(memory, percept.period_s, random, random.below(2) == 0);
    } else if (memory.turn_updates > 0) {
      --memory.turn_updates;
    } else if (meets(radio)) {
      memory.wait_updates = wait(percept);
      if (memory.wait_updates == 0) begin_turn(memory, percept.period_s, random, random.below(2) == 0);
    } else {
      const ScanAhead ahead = scanner.ahead(percept.ranges(k_scanner), params.min_front, params.min_front);
      if (ahead.obstruction) begin_turn(memory, percept.period_s, random, ahead.left < ahead.right);
    }
    const bool waits = memory.wait_updates > 0;
    if (has_led) {
      if (waits)
        actions.device<LedCommand>(k_led).show(1.0f, 0.6f, 0.0f);
      else
        actions.device<LedCommand>(k_led).show(0.2f, 0.5f, 1.0f);
    }
    const bool turns = memory.turn_updates > 0;
    actions.command = {waits || turns ? 0 : params.speed, 0, turns ? memory.turn : 0.0};
  }

  bool meets(const RadioPort& radio) const {
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message other = radio[i];
      if (other.range <= params.meet && std::abs(wrap_angle(radio_heading + other.bearing)) <= k_ahead)
        return true;
    }
    return false;
  }

  /// Duration of a wait that begins now, in decisions.
  std::uint32_t wait(const engine::Percept& percept) const {
    const std::span<const float> color = percept.devices[k_ground].field<float>(k_ground_color);
    const double brightness = (color[0] + color[1] + color[2]) / 3;
    const double square = brightness * brightness;
    return whole_decisions(params.max_wait * square / (square + params.half), percept.period_s);
  }

  void lint(const engine::LintView& view) const { warns_of_turning(view, scanner, params.min_front); }
};

}  // namespace

engine::ControllerKind beeclust_controller() {
  return engine::make_controller_kind<Beeclust>(
      "beeclust",
      "aggregate where the ground is bright: wait when another robot is met, and wait longer on brighter "
      "ground");
}

}  // namespace troupe::models
