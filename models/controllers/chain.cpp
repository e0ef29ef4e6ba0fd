#include "models/controllers/chain.hpp"

#include "base/geometry.hpp"
#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/spec/world_spec.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "models/devices/led.hpp"
#include "sensors/radio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

namespace troupe::models {
namespace {

using sensors::RadioPort;

constexpr std::uint8_t k_prey = 255;
constexpr double k_turn = 1.0;  // rad/s, away from obstacles ahead
constexpr double k_gain = 2.0;  // 1/s: turn rate per radian of the bearing of the goal
// Distances as fractions of the spacing:
constexpr double k_tolerance_share = 0.15;  // a robot this near to the place for a link is at the place
constexpr double k_home_share = 0.75;       // radius of the circle on which robots drive around the nest
constexpr double k_same_place_share = 0.5;  // below this distance, two links with one number are in one place

constexpr double k_longest_round_s = 30;  // longest time of circling around the nest
// A link leaves the chain if it has not heard the previous link for more than this number of decisions.
constexpr std::uint32_t k_patience = 20;
constexpr double k_avoid_s = 0.5;       // least time of turning away from an obstacle ahead
constexpr double k_more_avoid_s = 1.5;  // the random time of turning away exceeds k_avoid_s by less than this
constexpr double k_past_s = 0.8;        // time of driving past an obstacle after the turn

enum class Role : std::uint8_t { robot, nest, prey };
constexpr std::array<std::string_view, 3> names_of(Role) { return {"robot", "nest", "prey"}; }

struct Chain {
  struct Params {
    Role role = Role::robot;
    double spacing = 0.6;
    double speed = 0.1;
    double min_front = 0.15;
    double joins = 0.02;
    double leaves = 0.005;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::role>(
          "role",
          "robot: searches for the prey and forms chains; nest, prey: stands still as one end of the chains");
      d.member<&Params::spacing>("spacing", meters, above(0), at_most(10'000),
                                 "distance between neighbouring links (standing robots) of a chain");
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "forward speed");
      describe_min_front(d);
      d.member<&Params::joins>(
          "joins", within(0, 1),
          "probability per decision (call of the controller) that a robot becomes the next link of a chain "
          "while it is at the place of this link");
      d.member<&Params::leaves>("leaves", within(0, 1),
                                "probability per decision that the last link of a chain leaves the chain, as "
                                "long as the chain has not reached the prey");
    }
  };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::uint8_t link = 0;            ///< 1: the robot is a link
    std::uint8_t number = 0;          ///< number of the link, counted from the nest
    std::uint8_t path = 0;            ///< 1: the chain leads on from this link to the prey
    std::uint8_t homeward = 0;        ///< 1: the robot is on its way back to the nest
    std::uint32_t alone = 0;          ///< decisions since the link heard the link before it
    std::uint32_t round_updates = 0;  ///< decisions that remain of circling around the nest
    std::uint32_t turn_updates = 0;   ///< decisions that remain of the present turn
    std::uint32_t past_updates = 0;   ///< decisions that remain of driving straight on after a turn
    float turn = 0;                   ///< turn rate of the present turn, rad/s
    TROUPE_FIELDS(link, number, path, homeward, alone, round_updates, turn_updates, past_updates, turn)
  };
  /// The nest or a link that the robot hears: its number, its distance (m), and its position in the robot
  /// frame (m).
  struct Post {
    std::uint8_t number = 0;
    double range = std::numeric_limits<double>::infinity();
    Vec2 place = Vec2::Zero();
  };
  static constexpr bool needs_drive = false;
  static constexpr std::size_t k_radio = 0, k_scanner = 1;

  Params params;
  double radio_heading = 0;  // heading of the radio in the frame of the drive, rad
  Scanner scanner;
  std::size_t led = 0;  // index among the chosen devices; 0: none

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    if (const Result<> radio = choice.take_radio(2); !radio) return radio.error();
    radio_heading = devices[choice.chosen().front()].pose.heading;
    if (params.role == Role::robot) {
      const Result<Scanner> taken = choice.take_scanner(4);
      if (!taken) return taken.error();
      scanner = *taken;
    }
    if (choice.take_kind("led")) led = choice.chosen().size() - 1;
    return choice.chosen();
  }

  /// Robots need a drive; the nest and the prey do not. A device that drives a part moves a joint.
  Result<> bind_world(const engine::WorldSpec&, const engine::TypeSpec& type, std::uint32_t) const {
    if (params.role != Role::robot || type.drive || !type.joints.empty()) return {};
    return Error{fmt::format(
        "needs a drive for the role \"robot\", but type \"{}\" has none: add a drive to the type, "
        "or give the role \"nest\" or \"prey\"",
        type.name)};
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[k_radio], actions.devices[k_radio]);
    if (params.role == Role::prey) {
      radio.say(k_prey, std::uint8_t{1});
      return;
    }
    if (params.role == Role::nest) {
      memory.link = 1;
      listen_as_link(memory, percept, radio);
      radio.say(std::uint8_t{0}, memory.path);
      return;
    }
    if (memory.link != 0) {
      const bool stays = listen_as_link(memory, percept, radio);
      if (!stays || (memory.path == 0 && memory.alone == 0 && is_last(radio, memory.number) &&
                     random.uniform() < params.leaves))
        leave(memory);
    }
    if (memory.link == 0) explore(memory, percept, radio, random, actions.command);
    if (memory.link != 0) {
      actions.command = {};
      radio.say(memory.number, memory.path);
    } else {
      radio.be_silent();
    }
    if (led != 0) show(memory, actions.device<LedCommand>(led));
  }

  static void show(const Memory& memory, LedCommand& command) {
    constexpr std::array<std::array<float, 3>, 3> k_colors{
        {{0.95f, 0.8f, 0.1f}, {0.15f, 0.35f, 0.95f}, {0.1f, 0.7f, 0.25f}}};
    if (memory.link == 0) return command.show(0.7f, 0.7f, 0.7f);
    const std::array<float, 3>& color = k_colors[memory.number % k_colors.size()];
    command.show(color[0], color[1], color[2]);
  }

  // ---- as a link

  static void leave(Memory& memory) {
    memory = {};
    memory.homeward = 1;
  }

  static bool is_last(const RadioPort& radio, std::uint8_t number) {
    for (std::size_t i = 0; i < radio.count(); ++i)
      if (std::uint8_t n = 0, p = 0; radio[i].read(n, p) && n == number + 1) return false;
    return true;
  }

  /// Updates memory.path and memory.alone of a link from the messages that it hears. Returns false if the
  /// link must leave the chain.
  bool listen_as_link(Memory& memory, const engine::Percept& percept, const RadioPort& radio) const {
    bool has_path = false;
    const bool is_nest = params.role == Role::nest;
    bool has_inner = is_nest;
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message message = radio[i];
      std::uint8_t number = 0;
      std::uint8_t path = 0;
      if (!message.read(number, path)) continue;
      has_path = has_path || number == k_prey || (number == memory.number + 1 && path != 0);
      has_inner = has_inner || number + 1 == memory.number;
      if (!is_nest && number == memory.number && message.range < k_same_place_share * params.spacing &&
          message.sender < percept.body)
        return false;
    }
    memory.path = has_path && has_inner;
    memory.alone = has_inner ? 0 : memory.alone + 1;
    return memory.alone <= k_patience;
  }

  // ---- as an explorer

  /// Returns the nearest nest or link that the robot hears; if `wanted` is given, the nearest with this
  /// number. Returns nothing if the robot hears none. The prey does not count.
  std::optional<Post> nearest(const RadioPort& radio, std::optional<int> wanted = {}) const {
    Post best;
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message message = radio[i];
      std::uint8_t number = 0;
      std::uint8_t path = 0;
      if (!message.read(number, path) || number == k_prey || message.range >= best.range) continue;
      if (wanted && number != *wanted) continue;
      const SinCos way = sincos(radio_heading + message.bearing);
      best = {number, message.range, message.range * Vec2(way.cos, way.sin)};
    }
    return best.range < std::numeric_limits<double>::infinity() ? std::optional(best) : std::nullopt;
  }

  void explore(Memory& memory, const engine::Percept& percept, const RadioPort& radio, Random& random,
               engine::Command& command) const {
    if (avoids(memory, percept, random, command)) return;
    const std::optional<Post> post = nearest(radio);
    if (!post) {
      command = {params.speed, 0, 0};
      return;
    }
    const std::optional<Post> nest = nearest(radio, 0);
    if (memory.homeward != 0 && post->number == 0) {
      memory.homeward = 0;
      memory.round_updates = whole_decisions(random.uniform(0, k_longest_round_s), percept.period_s);
    }
    if (memory.homeward != 0) {
      head_for(nearest(radio, post->number - 1).value_or(*post).place, command);
      return;
    }
    if (memory.round_updates > 0 && nest) {
      --memory.round_updates;
      go_round(nest->place, command);
      return;
    }
    const Vec2 room = beyond(*post, nearest(radio, post->number - 1));
    const std::optional<Post> next = nearest(radio, post->number + 1);
    // At the nest there is also room for another chain, if `room` is far from the nearest first link.
    const bool has_room = !next || (post->number == 0 && (next->place - room).norm() > params.spacing);
    if (!has_room) {
      head_for(next->place, command);
      return;
    }
    if (room.norm() < k_tolerance_share * params.spacing && random.uniform() < params.joins &&
        post->number + 1 < k_prey) {
      memory = {};
      memory.link = 1;
      memory.number = static_cast<std::uint8_t>(post->number + 1);
      return;
    }
    head_for(room, command);
  }

  /// Position of the place for the link that follows `last`, m, robot frame. The place is at the distance
  /// `spacing` from `last`, on the line from `before`, the link before `last`, through `last`. If `last` is
  /// the nest, or `before` was not heard, the place is in the direction from `last` to the robot.
  Vec2 beyond(const Post& last, const std::optional<Post>& before) const {
    const Vec2 way = before && last.number > 0 ? Vec2(last.place - before->place) : Vec2(-last.place);
    const double length = way.norm();
    return last.place + (length > 0 ? Vec2(params.spacing / length * way) : Vec2(params.spacing, 0));
  }

  void head_for(const Vec2& place, engine::Command& command) const {
    const double angle = place == Vec2::Zero() ? 0 : atan2(place.y(), place.x());
    const double share = std::min(place.norm() / (k_tolerance_share * params.spacing), 1.0);
    command = {share * params.speed * std::max(0.0, cos(angle)), 0, k_gain * angle};
  }

  /// Commands a circle around the nest, whose position `centre` is in the robot frame, m. The circle is
  /// always counter-clockwise, so that all robots go in the same direction.
  void go_round(const Vec2& centre, engine::Command& command) const {
    const double range = std::max(centre.norm(), 1e-6);
    const Vec2 in = centre / range;
    const Vec2 along(in.y(), -in.x());
    head_for(along + 2 * (range / (k_home_share * params.spacing) - 1) * in, command);
  }

  bool avoids(Memory& memory, const engine::Percept& percept, Random& random,
              engine::Command& command) const {
    const ScanAhead ahead = scanner.ahead(percept.ranges(k_scanner), params.min_front, params.min_front);
    if (memory.turn_updates == 0 && ahead.obstruction) {
      memory.turn = static_cast<float>(ahead.left < ahead.right ? -k_turn : k_turn);
      memory.turn_updates = random_decisions(k_avoid_s, k_more_avoid_s, percept.period_s, random);
      memory.past_updates = decisions_for(k_past_s, percept.period_s);
    }
    if (memory.turn_updates > 0) {
      --memory.turn_updates;
      command = {0, 0, memory.turn};
      return true;
    }
    if (memory.past_updates > 0) {
      --memory.past_updates;
      command = {params.speed, 0, 0};
      return true;
    }
    return false;
  }

  void lint(const engine::LintView& view) const { warns_of_turning(view, scanner, params.min_front); }
};

}  // namespace

engine::ControllerKind chain_controller() {
  return engine::make_controller_kind<Chain>(
      "chain", "find the path from a nest to a prey by forming chains of standing robots");
}

}  // namespace troupe::models
