#include "models/controllers/chain.hpp"

#include "base/geometry.hpp"
#include "base/math.hpp"
#include "engine/controller.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "models/devices/led.hpp"
#include "sensors/radio.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

namespace troupe::models {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;
using sensors::payload_of;
using sensors::RadioPort;

constexpr std::uint8_t k_prey = 255;
constexpr double k_turn = 1.0;               // rad/s, away from what is ahead
constexpr double k_gain = 2.0;               // 1/s, towards where it goes
constexpr double k_tolerance_share = 0.15;   // of the spacing: it is where a link is to stand
constexpr double k_home_share = 0.75;        // of the spacing: how far from the nest it goes round it
constexpr double k_same_place_share = 0.5;   // of the spacing
constexpr double k_longest_round_s = 30;     // about the nest
constexpr std::uint32_t k_patience = 20;     // decisions without the link before it
constexpr std::uint32_t k_past_updates = 8;  // straight on, past what it has turned away from

const FieldTable& chain_fields() {
  static const FieldTable table{{
      {.name = "role",
       .type = FieldType::text,
       .fallback = std::string("robot"),
       .text = "what it is: a nest and a prey stand",
       .choices = {"robot", "nest", "prey"}},
      {.name = "spacing",
       .unit = Unit::meters,
       .fallback = 0.6,
       .min = 0,
       .max = 10000,
       .text = "from link to link",
       .above_min = true},
      {.name = "speed", .unit = Unit::meters_per_second, .fallback = 0.1, .min = 0, .text = "straight ahead"},
      min_front_field(0.15),
      {.name = "joins",
       .fallback = 0.02,
       .min = 0,
       .max = 1,
       .text = "chance in a decision that it becomes a link where there is room for one"},
      {.name = "leaves",
       .fallback = 0.005,
       .min = 0,
       .max = 1,
       .text = "chance in a decision that the last link of a chain leaves it"},
  }};
  return table;
}

struct Chain {
  struct Memory {
    std::uint8_t link = 0;      ///< 1: it stands as a link
    std::uint8_t number = 0;    ///< as a link, from the nest on
    std::uint8_t path = 0;      ///< 1: from here on there is a path to the prey
    std::uint8_t homeward = 0;  ///< 1: it goes back to the nest
    std::uint32_t alone = 0;    ///< decisions since it heard the link before it
    std::uint32_t round_updates = 0;
    std::uint32_t turn_updates = 0;
    std::uint32_t past_updates = 0;
    float turn = 0;  ///< rad/s
    TROUPE_FIELDS(link, number, path, homeward, alone, round_updates, turn_updates, past_updates, turn)
  };
  /// One that stands, as it is heard: where, robot frame, m.
  struct Post {
    std::uint8_t number = 0;
    double range = std::numeric_limits<double>::infinity();
    Vec2 place = Vec2::Zero();
  };
  static constexpr bool needs_drive = false;
  static constexpr std::size_t k_radio = 0, k_scanner = 1;

  bool is_nest, is_prey;
  double spacing, speed, min_front, joins, leaves;
  double radio_heading = 0;  // rad, of the radio in the frame of its drive
  Scanner scanner;
  std::size_t led = 0;  // its place among the devices; 0: none

  static Chain make(const Record& p) {
    return {p[0].text() == "nest", p[0].text() == "prey", p[1].number(), p[2].number(),
            p[3].number(),         p[4].number(),         p[5].number()};
  }

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> devices,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const bool has_radio = choice.take([](const engine::DeviceInfo& device) {
      return device.kind == "radio" && payload_of(device.prepared) >= 2;
    });
    if (!has_radio) return Error{"needs a radio with a payload of 2 bytes or more"};
    radio_heading = devices[choice.chosen().front()].pose.heading;
    if (!is_nest && !is_prey) {
      const Result<Scanner> taken = choice.take_scanner(4);
      if (!taken) return taken.error();
      scanner = *taken;
    }
    if (choice.take_kind("led")) led = choice.chosen().size() - 1;
    return choice.chosen();
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    const RadioPort radio(percept.devices[k_radio], actions.devices[k_radio]);
    if (is_prey) {
      radio.say(k_prey, std::uint8_t{1});
      return;
    }
    if (is_nest) {
      memory.link = 1;
      listen_as_link(memory, percept, radio);
      radio.say(std::uint8_t{0}, memory.path);
      return;
    }
    if (memory.link != 0) {
      const bool stays = listen_as_link(memory, percept, radio);
      if (!stays || (memory.path == 0 && memory.alone == 0 && is_last(radio, memory.number) &&
                     random.uniform() < leaves))
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

  /// False where it cannot stay.
  bool listen_as_link(Memory& memory, const engine::Percept& percept, const RadioPort& radio) const {
    bool has_path = false;
    bool has_inner = is_nest;
    for (std::size_t i = 0; i < radio.count(); ++i) {
      const RadioPort::Message message = radio[i];
      std::uint8_t number = 0;
      std::uint8_t path = 0;
      if (!message.read(number, path)) continue;
      has_path = has_path || number == k_prey || (number == memory.number + 1 && path != 0);
      has_inner = has_inner || number + 1 == memory.number;
      if (!is_nest && number == memory.number && message.range < k_same_place_share * spacing &&
          message.sender < percept.body)
        return false;
    }
    memory.path = has_path && has_inner;
    memory.alone = has_inner ? 0 : memory.alone + 1;
    return memory.alone <= k_patience;
  }

  // ---- as an explorer

  /// The nearest that says this number, or, without one, the nearest of all but the prey.
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
      command = {speed, 0, 0};
      return;
    }
    const std::optional<Post> nest = nearest(radio, 0);
    if (memory.homeward != 0 && post->number == 0) {
      memory.homeward = 0;
      memory.round_updates =
          static_cast<std::uint32_t>(random.uniform(0, k_longest_round_s) / percept.tick_s);
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
    // From the nest chains may lead in several directions.
    const bool has_room = !next || (post->number == 0 && (next->place - room).norm() > spacing);
    if (!has_room) {
      head_for(next->place, command);
      return;
    }
    if (room.norm() < k_tolerance_share * spacing && random.uniform() < joins && post->number + 1 < k_prey) {
      memory = {};
      memory.link = 1;
      memory.number = static_cast<std::uint8_t>(post->number + 1);
      return;
    }
    head_for(room, command);
  }

  /// Where the next link is to stand: in line with the last two; at the nest, where the robot is.
  Vec2 beyond(const Post& last, const std::optional<Post>& before) const {
    const Vec2 way = before && last.number > 0 ? Vec2(last.place - before->place) : Vec2(-last.place);
    const double length = way.norm();
    return last.place + (length > 0 ? Vec2(spacing / length * way) : Vec2(spacing, 0));
  }

  void head_for(const Vec2& place, engine::Command& command) const {
    const double angle = place == Vec2::Zero() ? 0 : atan2(place.y(), place.x());
    const double share = std::min(place.norm() / (k_tolerance_share * spacing), 1.0);
    command = {share * speed * std::max(0.0, cos(angle)), 0, k_gain * angle};
  }

  /// Counter-clockwise, so that all go the same way.
  void go_round(const Vec2& centre, engine::Command& command) const {
    const double range = std::max(centre.norm(), 1e-6);
    const Vec2 in = centre / range;
    const Vec2 along(in.y(), -in.x());
    head_for(along + 2 * (range / (k_home_share * spacing) - 1) * in, command);
  }

  bool avoids(Memory& memory, const engine::Percept& percept, Random& random,
              engine::Command& command) const {
    const ScanAhead ahead = scanner.look(percept.ranges(k_scanner), min_front, min_front);
    if (memory.turn_updates == 0 && ahead.obstruction) {
      memory.turn = static_cast<float>(ahead.left < ahead.right ? -k_turn : k_turn);
      memory.turn_updates = 5 + random.below(15);
      memory.past_updates = k_past_updates;
    }
    if (memory.turn_updates > 0) {
      --memory.turn_updates;
      command = {0, 0, memory.turn};
      return true;
    }
    if (memory.past_updates > 0) {
      --memory.past_updates;
      command = {speed, 0, 0};
      return true;
    }
    return false;
  }
};

}  // namespace

engine::ControllerKind chain_controller() {
  return engine::make_controller_kind<Chain>(
      "chain", "find the way from a nest to a prey as links of chains that stand", chain_fields());
}

}  // namespace troupe::models
