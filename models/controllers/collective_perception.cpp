#include "models/controllers/collective_perception.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "models/devices/led.hpp"
#include "sensors/ground.hpp"
#include "sensors/radio.hpp"

#include <algorithm>
#include <array>

namespace troupe::models {
namespace {

using sensors::k_ground_color;
using sensors::RadioPort;

constexpr double k_listen_s = 3;        // only messages heard in this time before the end of sharing count
constexpr double k_straight_s = 10;     // mean time of driving straight on
constexpr double k_turn = 0.8;          // rad/s
constexpr double k_avoid_s = 0.5;       // least time of turning away from an obstacle ahead
constexpr double k_more_avoid_s = 1.5;  // the random time of turning away exceeds k_avoid_s by less than this
constexpr double k_stop_share = 0.6;    // stop distance for Scanner::ahead(), as a fraction of `min_front`
constexpr float k_middle = 0.5f;        // brightness below which ground is black

enum class Rule : std::uint8_t { majority, voter };
constexpr std::array<std::string_view, 2> names_of(Rule) { return {"majority", "voter"}; }

struct CollectivePerception {
  struct Params {
    double speed = 0.16;
    double explore = 10;
    double share = 10;
    Rule rule = Rule::majority;
    double min_front = 0.15;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "forward speed");
      d.member<&Params::explore>(
          "explore", seconds, above(0), at_most(1e6),
          "mean time for which a robot explores the floor before it shares its opinion");
      d.member<&Params::share>("share", seconds, above(0), at_most(1e6),
                               "mean time for which a robot broadcasts its opinion if all its floor readings "
                               "agree with the opinion; otherwise, this time is multiplied by the fraction "
                               "of the readings that agree");
      d.member<&Params::rule>(
          "rule",
          "how a robot adopts an opinion. majority: the most frequent opinion among those "
          "received and its own; voter: a random one of the opinions received");
      describe_min_front(d);
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::uint32_t updates_left = 0;        ///< decisions that remain of exploring or sharing
    std::uint32_t looked = 0;              ///< number of floor readings since the robot began to explore
    std::uint32_t agreed = 0;              ///< how many of these readings have the colour of its opinion
    std::array<std::uint32_t, 2> votes{};  ///< messages heard for black and for white
    std::int32_t straight_updates = 0;     ///< decisions that remain of driving straight on
    std::int32_t turn_updates = 0;         ///< decisions that remain of the present turn
    float turn = 0;                        ///< turn rate of the present turn, rad/s
    std::uint8_t opinion = 0;              ///< a FloorOpinion
    std::uint8_t shares = 0;               ///< 1: the robot shares its opinion; 0: it explores
    std::uint8_t begun = 0;                ///< 1: this is not the first decision of the robot
    TROUPE_FIELDS(updates_left, looked, agreed, votes, straight_updates, turn_updates, turn, opinion, shares,
                  begun)
  };
  static constexpr std::size_t k_ground = 0, k_radio = 1, k_scanner = 2, k_led = 3;

  Params params;
  Scanner scanner;
  bool has_led = false;

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const Result<Scanner> taken = choice.take_ground_radio_scanner(4);
    if (!taken) return taken.error();
    scanner = *taken;
    has_led = choice.take_kind("led");
    return choice.chosen();
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[k_radio], actions.devices[k_radio]);
    if (memory.begun == 0) {
      memory.begun = 1;
      memory.opinion = static_cast<std::uint8_t>(percept.body % 2);
      begin_exploring(memory, percept, random);
    }
    if (memory.shares == 0)
      sample_ground(memory, percept);
    else if (memory.updates_left * percept.period_s <= k_listen_s)
      hear(memory, radio);
    if (memory.updates_left > 0) {
      --memory.updates_left;
    } else if (memory.shares == 0) {
      begin_sharing(memory, percept, random);
    } else {
      decide(memory, random);
      begin_exploring(memory, percept, random);
    }
    if (memory.shares != 0)
      radio.say(memory.opinion);
    else
      radio.be_silent();
    if (has_led) {
      const float grey = memory.shares == 0 ? k_middle : static_cast<float>(memory.opinion);
      actions.device<LedCommand>(k_led).show(grey, grey, grey);
    }
    walk(memory, percept, random, actions.command);
  }

  /// An exponentially distributed random time with the mean mean_s (s), as a number of decisions.
  static std::uint32_t updates(double mean_s, const engine::Percept& percept, Random& random) {
    return whole_decisions(random.exponential() * mean_s, percept.period_s);
  }

  void begin_exploring(Memory& memory, const engine::Percept& percept, Random& random) const {
    memory.shares = 0;
    memory.looked = 0;
    memory.agreed = 0;
    memory.updates_left = updates(params.explore, percept, random);
  }

  void begin_sharing(Memory& memory, const engine::Percept& percept, Random& random) const {
    const double quality = static_cast<double>(memory.agreed) / std::max<std::uint32_t>(memory.looked, 1);
    memory.shares = 1;
    memory.votes = {};
    memory.updates_left = updates(params.share * quality, percept, random);
  }

  static void sample_ground(Memory& memory, const engine::Percept& percept) {
    const std::span<const float> color = percept.devices[k_ground].field<float>(k_ground_color);
    const bool is_white = (color[0] + color[1] + color[2]) / 3 > k_middle;
    ++memory.looked;
    memory.agreed += is_white == (memory.opinion != 0);
  }

  static void hear(Memory& memory, const RadioPort& radio) {
    for (std::size_t i = 0; i < radio.count(); ++i)
      if (std::uint8_t opinion = 0; radio[i].read(opinion) && opinion < 2) ++memory.votes[opinion];
  }

  void decide(Memory& memory, Random& random) const {
    const std::uint32_t all = memory.votes[0] + memory.votes[1];
    if (all == 0) return;
    if (params.rule == Rule::voter) {
      memory.opinion = random.below(all) < memory.votes[1];
      return;
    }
    // The robot's own opinion counts as one message. Another robot may be heard once in each tick.
    std::array<std::uint32_t, 2> votes = memory.votes;
    ++votes[memory.opinion != 0];
    if (votes[0] != votes[1]) memory.opinion = votes[1] > votes[0];
  }

  void walk(Memory& memory, const engine::Percept& percept, Random& random, engine::Command& command) const {
    const auto [obstruction, stop, left, right] =
        scanner.ahead(percept.ranges(k_scanner), params.min_front, k_stop_share * params.min_front);
    if (memory.turn_updates == 0 && obstruction) {
      memory.turn = static_cast<float>(left < right ? -k_turn : k_turn);
      memory.turn_updates =
          static_cast<std::int32_t>(random_decisions(k_avoid_s, k_more_avoid_s, percept.period_s, random));
    } else if (memory.turn_updates == 0 && --memory.straight_updates < 0) {
      memory.turn = static_cast<float>(random.below(2) == 0 ? -k_turn : k_turn);
      memory.turn_updates =
          static_cast<std::int32_t>(whole_decisions(random.uniform(0, k_pi / k_turn), percept.period_s));
      memory.straight_updates = static_cast<std::int32_t>(updates(k_straight_s, percept, random));
    }
    if (memory.turn_updates == 0) {
      command = {params.speed, 0, 0};
      return;
    }
    --memory.turn_updates;
    command = {0, 0, memory.turn};
  }

  void lint(const engine::LintView& view) const { warns_of_turning(view, scanner, params.min_front); }
};

}  // namespace

engine::ControllerKind collective_perception_controller() {
  return engine::make_controller_kind<CollectivePerception>(
      "collective_perception", "decide collectively whether more of the floor is black or white");
}

}  // namespace troupe::models
