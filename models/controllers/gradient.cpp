#include "models/controllers/gradient.hpp"

#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "models/devices/led.hpp"
#include "sensors/radio.hpp"

#include <algorithm>
#include <limits>

namespace troupe::models {
namespace {

using engine::DeviceInfo;
using sensors::RadioPort;

constexpr double k_stop_share = 0.6;   // fraction of min_front below which robots turn on the spot
constexpr double k_creep_share = 0.2;  // fraction of `speed` at which robots drive while they turn away
constexpr double k_turn = 0.8;         // rad/s
constexpr double k_avoid_s = 0.5;      // least time of turning away from an obstacle ahead
constexpr double k_more_avoid_s = 2;   // the random time of turning away exceeds k_avoid_s by less than this
constexpr double k_backwards_s = 2;    // time of driving backwards when no settled robot is heard
constexpr std::uint8_t k_halt = 3;     // decisions: long enough to stop and then receive messages
constexpr float k_far_hops = 12;       // an LED shows this number of hops and all greater ones alike
// Probability per decision of halting to settle: low, so that two robots rarely settle in one place at once.
constexpr double k_settles = 0.02;

struct Gradient {
  struct Params {
    bool beacon = false;
    double spacing = 1;
    double speed = 0.3;
    double min_front = 0.4;
    std::uint32_t patience = 20;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::beacon>("beacon",
                                "true: the robot is a beacon: it stands still, and other robots count their "
                                "radio hops to it");
      d.member<&Params::spacing>(
          "spacing", meters, within(0, 10'000),
          "a robot settles (stands still for good) only where the nearest settled robot that it hears is at "
          "least this far away");
      d.member<&Params::speed>("speed", meters_per_second, at_least(0),
                               "speed of the robot until it settles");
      describe_min_front(d);
      d.member<&Params::patience>(
          "patience", within(1, 1'000'000),
          "number of decisions (calls of the controller) after which a robot recomputes its number of hops "
          "to the beacon, if no message has confirmed this number in the meantime");
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::uint32_t hops = k_hops_unknown;  ///< hop count of a settled robot
    std::uint32_t unconfirmed = 0;        ///< decisions since a message confirmed `hops`
    std::uint32_t alone = 0;              ///< decisions since the robot heard a settled robot
    std::int32_t avoid_updates = 0;       ///< decisions that remain of the present turn
    std::uint8_t settled = 0;             ///< 1: the robot is settled
    std::uint8_t halts = 0;               ///< decisions that remain of halting before the robot settles
    TROUPE_FIELDS(hops, unconfirmed, alone, avoid_updates, settled, halts)
  };
  /// Summary of the messages that a robot hears at a decision.
  struct Heard {
    std::uint32_t hops = k_hops_unknown;                     ///< smallest hop count heard
    float nearest = std::numeric_limits<float>::infinity();  ///< distance to the nearest robot heard, m
  };
  static constexpr bool needs_drive = false;

  Params params;
  Scanner scanner;
  std::size_t led = 0;  // index among the chosen devices; 0: none

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    if (!choice.take_kind("radio"))
      return choice.missing("radio", "needs a radio (a device of kind \"radio\")");
    if (!params.beacon) {
      const Result<Scanner> taken = choice.take_scanner(3);
      // A robot without a ranger is meant to stand still. A ranger that cannot be used is an error: otherwise
      // the robot would also stand still, and the user would not learn why.
      for (std::size_t d = 0; d < devices.size() && !taken; ++d)
        if (!claimed[d] && !devices[d].prepared.bearings.empty()) return taken.error();
      if (taken) scanner = *taken;
    }
    if (choice.take_kind("led")) led = choice.chosen().size() - 1;
    return choice.chosen();
  }

  static Heard listen(const RadioPort& radio) {
    Heard heard;
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message message = radio[i];
      std::uint8_t hops = 0;
      if (!message.read(hops)) continue;
      heard.hops = std::min<std::uint32_t>(heard.hops, hops);
      heard.nearest = std::min(heard.nearest, message.range);
    }
    return heard;
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[0], actions.devices[0]);
    const Heard heard = listen(radio);
    const bool in_touch = heard.hops != k_hops_unknown;
    if (params.beacon) {
      memory.settled = 1;
      memory.hops = 0;
    } else {
      const bool has_room = in_touch && heard.nearest >= params.spacing;
      if (!scanner.is_usable()) memory.settled = 1;
      // The robot must not settle if it has stopped out of radio range of the settled robots.
      if (memory.halts > 0 && --memory.halts == 0 && has_room) memory.settled = 1;
      if (memory.halts == 0 && has_room && random.uniform() < k_settles) memory.halts = k_halt;
      if (memory.settled != 0) count(memory, heard);
    }
    if (led != 0) show(memory, actions.device<LedCommand>(led));
    if (memory.settled != 0) {
      actions.command = {};
      if (memory.hops == k_hops_unknown)
        radio.be_silent();
      else
        radio.say(static_cast<std::uint8_t>(memory.hops));
      return;
    }
    memory.alone = in_touch ? 0 : memory.alone + 1;
    if (memory.halts > 0) {
      actions.command = {};
      return;
    }
    roam(memory, percept, random, actions.command);
  }

  static void show(const Memory& memory, LedCommand& command) {
    if (memory.settled == 0) return command.show(0.75f, 0.75f, 0.75f);
    const float share = std::min(static_cast<float>(memory.hops) / k_far_hops, 1.0f);
    command.show(1 - share, 0.35f, share);
  }

  void count(Memory& memory, const Heard& heard) const {
    const std::uint32_t hops = std::min<std::uint32_t>(heard.hops + 1, k_hops_unknown);
    if (hops <= memory.hops || ++memory.unconfirmed > params.patience) {
      memory.hops = hops;
      memory.unconfirmed = 0;
    }
  }

  void roam(Memory& memory, const engine::Percept& percept, Random& random, engine::Command& command) const {
    if (memory.alone > 0 && memory.alone <= decisions_for(k_backwards_s, percept.period_s)) {
      command = {-params.speed, 0, 0};
      memory.avoid_updates = 0;
      return;
    }
    const auto [obstruction, stop, left, right] =
        scanner.ahead(percept.ranges(1), params.min_front, k_stop_share * params.min_front);
    if (!obstruction && memory.avoid_updates == 0) {
      command = {params.speed, 0, 0};
      return;
    }
    const double forward = stop ? 0 : k_creep_share * params.speed;
    if (memory.avoid_updates == 0) {
      memory.avoid_updates =
          static_cast<std::int32_t>(random_decisions(k_avoid_s, k_more_avoid_s, percept.period_s, random));
      command.turn = left < right ? -k_turn : k_turn;
    }
    command = {forward, 0, command.turn};
    --memory.avoid_updates;
  }

  void lint(const engine::LintView& view) const { warns_of_turning(view, scanner, params.min_front); }
};

}  // namespace

engine::ControllerKind gradient_controller() {
  return engine::make_controller_kind<Gradient>(
      "gradient",
      "settle (stand still) within radio range of settled robots, and count the radio hops to a beacon");
}

}  // namespace troupe::models
