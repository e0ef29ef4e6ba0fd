#include "models/controllers/informed_aggregation.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/evasion.hpp"
#include "models/controllers/random_turn.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "sensors/ground.hpp"
#include "sensors/radio.hpp"

#include <algorithm>

namespace troupe::models {
namespace {

using sensors::k_ground_color;
using sensors::RadioPort;

constexpr float k_black = 0.25f;  // brightness below which ground is black
constexpr float k_white = 0.75f;  // brightness above which ground is white

enum Ground : std::uint8_t { k_plain, k_is_black, k_is_white };
enum Does : std::uint8_t { k_walks, k_enters, k_stands };

enum class Informed : std::uint8_t { no, black, white };
constexpr std::array<std::string_view, 3> names_of(Informed) { return {"no", "black", "white"}; }

struct InformedAggregation {
  struct Params {
    Informed informed = Informed::no;
    double speed = 0.1;
    double enter = 8;
    double leave = 0.04;
    double others = 0.25;
    double min_front = 0.08;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::informed>(
          "informed",
          "colour of the sites (black or white areas of the ground) on which the robot stops; no: it stops "
          "on sites of both colours");
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "forward speed");
      d.member<&Params::enter>(
          "enter", seconds, within(0, 1e6),
          "longest time for which the robot drives on inside a site before it stops; the time is random");
      d.member<&Params::leave>("leave", per_second, at_least(0),
                               "rate at which a robot leaves its site while it hears no other robot there");
      d.member<&Params::others>(
          "others", within(0, 1000),
          "each robot that is heard standing on a site of the same colour multiplies the rate `leave` by "
          "exp(-others)");
      describe_min_front(d);
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::uint32_t enter_updates = 0;   ///< decisions that remain of driving on inside a site
    std::uint32_t turn_updates = 0;    ///< decisions that remain of the present turn
    std::uint32_t still_updates = 0;   ///< consecutive decisions in which a command did not move the robot
    std::uint32_t escape_updates = 0;  ///< decisions that remain of backing out
    double x = 0;                      ///< estimated x at the last decision, m
    double y = 0;                      ///< estimated y at the last decision, m
    double heading = 0;                ///< estimated heading at the last decision, rad
    float turn = 0;                    ///< turn rate of the present turn, rad/s
    std::uint8_t does = 0;             ///< what the robot does, one of Does
    std::uint8_t site = 0;             ///< colour of the site that the robot enters or stands on, a Ground
    std::uint8_t leaves = 0;           ///< 1: the robot must leave the site before it may stop again
    TROUPE_FIELDS(enter_updates, turn_updates, still_updates, escape_updates, x, y, heading, turn, does, site,
                  leaves)
  };
  static constexpr std::size_t k_ground = 0, k_radio = 1, k_scanner = 2;

  Params params;
  Scanner scanner;
  Evasion evasion;

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const Result<Scanner> taken = choice.take_ground_radio_scanner(4);
    if (!taken) return taken.error();
    scanner = *taken;
    return choice.chosen();
  }

  Result<> bind_world(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
    evasion.drive_period = drive_period(world, type, part);
    return {};
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[k_radio], actions.devices[k_radio]);
    const Ground ground = ground_below(percept);
    if (memory.does == k_stands) {
      const double rate =
          params.leave * exp(-params.others * static_cast<double>(standing_here(radio, memory.site)));
      if (random.uniform() < rate * percept.period_s) {
        memory.does = k_walks;
        memory.leaves = 1;
        begin_turn(memory, percept.period_s, random, random.below(2) == 0);
        memory.turn_updates = std::max(2u, memory.turn_updates);  // walk() counts this decision at once
      }
    } else {
      find_site(memory, ground, percept, random);
    }
    if (memory.does == k_stands) {
      radio.say(memory.site);
      actions.command = {};
    } else {
      radio.be_silent();
      walk(memory, percept, random, actions.command);
    }
  }

  static Ground ground_below(const engine::Percept& percept) {
    const std::span<const float> color = percept.devices[k_ground].field<float>(k_ground_color);
    const float brightness = (color[0] + color[1] + color[2]) / 3;
    return brightness < k_black ? k_is_black : brightness > k_white ? k_is_white : k_plain;
  }

  static std::size_t standing_here(const RadioPort& radio, std::uint8_t site) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < radio.count(); ++i)
      if (std::uint8_t theirs = 0; radio[i].read(theirs) && theirs == site) ++count;
    return count;
  }

  void find_site(Memory& memory, Ground ground, const engine::Percept& percept, Random& random) const {
    if (ground == k_plain) memory.leaves = 0;
    const bool may_stop = memory.leaves == 0 &&
                          (ground == k_is_black ? params.informed != Informed::white
                                                : ground == k_is_white && params.informed != Informed::black);
    if (!may_stop) {
      memory.does = k_walks;
    } else if (memory.does == k_walks || memory.site != ground) {
      memory.does = k_enters;
      memory.site = ground;
      memory.enter_updates = whole_decisions(random.uniform(0, params.enter), percept.period_s);
    } else if (memory.enter_updates > 0) {
      --memory.enter_updates;
    } else {
      memory.does = k_stands;
    }
  }

  void walk(Memory& memory, const engine::Percept& percept, Random& random, engine::Command& command) const {
    if (evasion.escapes(memory, percept, random, command)) return;
    if (memory.turn_updates > 0) {
      --memory.turn_updates;
    } else {
      const ScanAhead ahead = scanner.ahead(percept.ranges(k_scanner), params.min_front, params.min_front);
      if (ahead.obstruction) begin_turn(memory, percept.period_s, random, ahead.left < ahead.right);
    }
    const bool turns = memory.turn_updates > 0;
    command = {turns ? 0 : params.speed, 0, turns ? memory.turn : 0.0};
  }

  void lint(const engine::LintView& view) const { warns_of_turning(view, scanner, params.min_front); }
};

}  // namespace

engine::ControllerKind informed_aggregation_controller() {
  return engine::make_controller_kind<InformedAggregation>(
      "informed_aggregation", "gather on black or white sites, staying longer the more robots stand there");
}

}  // namespace troupe::models
