#include "models/controllers/collector.hpp"

#include "engine/kinds/controller.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/world_spec.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/evasion.hpp"
#include "models/controllers/fiducial_readings.hpp"
#include "models/devices/gripper.hpp"
#include "models/devices/power.hpp"
#include "partition/box_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::models {
namespace {

using engine::DeviceInfo;
using engine::WorldSpec;

// Distances in m, speeds in m/s, angles in rad, gains in 1/s, durations in s.
constexpr double k_cruise = 0.3;
constexpr double k_creep = 0.1;
constexpr double k_creep_within = 0.5;  // distance to a puck within which the robot drives at k_creep
constexpr double k_aligned = 0.1;       // bearing of a puck beyond which the robot turns on the spot
constexpr double k_drive_within = 1.0;  // bearing of any other goal beyond which the robot turns on the spot
constexpr double k_turn_gain = 1;
constexpr double k_at_sink = 0.5;     // distance to a sink within which the robot releases the puck
constexpr double k_delivered = 0.8;   // pucks nearer than this to a sink count as delivered
constexpr double k_at_charger = 0.4;  // distance to a charger within which the robot stands still
constexpr double k_low = 0.25;        // a pack below this fraction of its capacity must be charged
constexpr double k_full = 0.95;       // charging ends above this fraction of the capacity
constexpr double k_patience_s = 3;    // longest wait for the paddles to close or to open, which takes 2 s
constexpr double k_back_off_s = 1.5;  // time of driving backwards from a sink or a charger
constexpr double k_turn_s = 1;        // least time of turning away from a sink or a charger
constexpr double k_more_turn_s = 2;   // the random time of turning away exceeds k_turn_s by less than this

struct Collector {
  enum Mode : std::uint8_t { seeking, gripping, carrying, releasing, leaving, charging };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::int32_t avoid_updates = 0;    ///< decisions that remain of the present turn
    std::uint32_t still_updates = 0;   ///< consecutive decisions in which a command did not move the robot
    std::uint32_t escape_updates = 0;  ///< decisions that remain of backing out
    std::uint32_t updates = 0;         ///< decisions since the robot entered the mode
    std::uint32_t goal = 0;            ///< index of the robot's present goal in `sinks` or `chargers`
    double x = 0;                      ///< estimated x at the last decision, m
    double y = 0;                      ///< estimated y at the last decision, m
    double heading = 0;                ///< estimated heading at the last decision, rad
    std::uint8_t mode = seeking;       ///< a Mode
    TROUPE_FIELDS(avoid_updates, still_updates, escape_updates, updates, goal, x, y, heading, mode)
  };
  /// A puck in sight of the fiducial finder.
  struct Puck {
    double range = 0;    ///< m
    double bearing = 0;  ///< rad, from straight ahead of the drive
  };
  static constexpr std::size_t k_scanner = 0, k_finder = 1, k_gripper = 2, k_pack = 3;

  struct Params {
    std::string sink = "sink";
    std::int32_t puck = 1;
    std::int32_t charger = 2;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      constexpr double k_most_mark = 1e9;
      d.member<&Params::sink>(
          "sink",
          "name of the sinks, the models to which pucks are brought; models whose name is "
          "this name followed by digits, such as sink2, are also sinks");
      d.member<&Params::puck>("puck", within(-k_most_mark, k_most_mark),
                              "fiducial_return of the pucks, by which the fiducial finder recognises them");
      d.member<&Params::charger>("charger", within(-k_most_mark, k_most_mark),
                                 "fiducial_return of the models at which robots charge");
    }
  };

  Params params;
  Scanner scanner;
  Evasion evasion{.min_front = 0.5, .stop = 0.3};
  FiducialReadings sights;  // reads the fiducial finder
  bool has_pack = false;
  std::vector<Vec2> sinks, chargers;
  partition::BoxGrid sinks_about;  // finds the sinks within k_delivered of a puck

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed);
  Result<> bind_world(const WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part);
  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const;

 private:
  static void enter(Memory& memory, Mode mode) {
    memory.mode = mode;
    memory.updates = 0;
    memory.avoid_updates = 0;  // a turn ends with its mode: leave() draws the length of its own turn
  }
  static std::uint32_t nearest(std::span<const Vec2> places, const Vec2& from) {
    const auto distance2 = [&](const Vec2& place) { return (place - from).squaredNorm(); };
    return static_cast<std::uint32_t>(std::ranges::min_element(places, {}, distance2) - places.begin());
  }
  static std::uint8_t& order(const engine::Actions& actions) {
    return actions.device<GripperCommand>(k_gripper).order;
  }
  bool is_delivered(const Vec2& puck) const {
    return sinks_about.any_near(Box::around(puck, 0),
                                [&](std::uint32_t i) { return (sinks[i] - puck).norm() < k_delivered; });
  }
  std::optional<Puck> puck_in_sight(const engine::Percept& percept) const;
  void seek(Memory& memory, const engine::Percept& percept, Random& random, engine::Actions& actions) const;
  void grip(Memory& memory, const engine::Percept& percept, engine::Actions& actions) const;
  static void leave(Memory& memory, const engine::Percept& percept, Random& random, engine::Actions& actions);
  void head_for(const Vec2& goal, Memory& memory, const engine::Percept& percept, Random& random,
                engine::Actions& actions) const;
};

Result<std::vector<std::size_t>> Collector::choose(std::span<const DeviceInfo> devices,
                                                   std::vector<bool>& claimed) {
  for (const auto& [mark, name] : {std::pair(params.puck, "puck"), {params.charger, "charger"}})
    if (mark == 0)
      return Error{fmt::format(
          "has a `{}` of 0, but 0 is the fiducial_return of models that have no mark: give another number",
          name)};
  DeviceChoice choice(devices, claimed);
  const Result<Scanner> taken = choice.take_scanner(Evasion::window_share);
  if (!taken) return taken.error();
  scanner = *taken;
  if (!choice.take_kind("fiducial"))
    return choice.missing("fiducial", "needs a fiducial finder (a device of kind \"fiducial\")");
  if (!choice.take_kind("gripper"))
    return choice.missing("gripper", "needs a gripper (a device of kind \"gripper\")");
  sights = FiducialReadings(devices[choice.chosen()[k_finder]]);
  has_pack = choice.take_kind("power_pack");
  return choice.chosen();
}

Result<> Collector::bind_world(const WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
  evasion.drive_period = drive_period(world, type, part);
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    if (!world.starts(BodyId(b))) continue;
    const std::string name = world.name(BodyId(b));
    if (name == params.sink || engine::is_of_population(name, params.sink))
      sinks.push_back(world.bodies[b].pose_world_body.position());
  }
  if (has_pack)
    for (const MarkedBody& charger : bodies_with_mark(world, params.charger)) chargers.push_back(charger.at);
  if (sinks.empty())
    return Error{
        fmt::format("needs a model in the world named \"{}\", or several named \"{}0\", \"{}1\" and so on",
                    params.sink, params.sink, params.sink)};
  std::vector<Box> boxes;
  for (const Vec2& at : sinks) boxes.push_back(Box::around(at, k_delivered + 1e-6));
  sinks_about = partition::BoxGrid(boxes);
  return {};
}

void Collector::operator()(Memory& memory, const engine::Percept& percept, Random& random,
                           engine::Actions& actions) const {
  const auto& gripper = percept.devices[k_gripper].as<GripperState>();
  const Vec2 here = percept.estimate.position();
  ++memory.updates;
  // An intervention may have removed the sink or the charger that was chosen. A memory from a checkpoint may
  // have any values.
  if (memory.mode > charging) enter(memory, seeking);
  if (memory.mode == carrying && memory.goal >= sinks.size()) memory.goal = nearest(sinks, here);
  if (memory.mode == charging && chargers.empty()) enter(memory, leaving);
  if (memory.mode == charging && memory.goal >= chargers.size()) memory.goal = nearest(chargers, here);
  if (memory.mode == seeking && !chargers.empty() &&
      percept.devices[k_pack].as<PowerPackState>().proportion_remaining() < k_low) {
    enter(memory, charging);
    memory.goal = nearest(chargers, here);
  }
  if (evasion.escapes(memory, percept, random, actions.command)) return;
  switch (memory.mode) {
    case seeking: return seek(memory, percept, random, actions);
    case gripping: return grip(memory, percept, actions);
    case carrying:
      if (gripper.held == 0) return enter(memory, leaving);
      if ((sinks[memory.goal] - here).norm() > k_at_sink)
        return head_for(sinks[memory.goal], memory, percept, random, actions);
      enter(memory, releasing);
      [[fallthrough]];
    case releasing:
      actions.command = {};
      order(actions) = GripperCommand::open;
      // Robots at one sink may block one another's paddles. They back off, and the paddles open on the way.
      if (gripper.held == 0 && (gripper.paddles == GripperState::is_open ||
                                memory.updates > decisions_for(k_patience_s, percept.period_s)))
        enter(memory, leaving);
      return;
    case leaving: return leave(memory, percept, random, actions);
    default:  // charging
      if (percept.devices[k_pack].as<PowerPackState>().proportion_remaining() > k_full)
        enter(memory, leaving);
      else if ((chargers[memory.goal] - here).norm() < k_at_charger)
        actions.command = {};
      else
        head_for(chargers[memory.goal], memory, percept, random, actions);
  }
}

/// The nearest puck that the finder sees and that is not yet at a sink. Returns nothing if there is none.
std::optional<Collector::Puck> Collector::puck_in_sight(const engine::Percept& percept) const {
  const engine::Readings& seen = percept.devices[k_finder];
  for (std::size_t i = 0; i < sights.count(seen); ++i)
    if (sights.id(seen, i) == params.puck && !is_delivered(sights.position(seen, i)))
      return Puck{sights.range(seen, i), sights.bearing(seen, i)};
  return {};
}

void Collector::seek(Memory& memory, const engine::Percept& percept, Random& random,
                     engine::Actions& actions) const {
  const auto& gripper = percept.devices[k_gripper].as<GripperState>();
  order(actions) = GripperCommand::open;
  if (gripper.beam_inner != 0 && gripper.paddles == GripperState::is_open) {
    enter(memory, gripping);
    return grip(memory, percept, actions);
  }
  const std::optional<Puck> puck = puck_in_sight(percept);
  const bool is_near = puck && puck->range < k_creep_within;
  if (!is_near && evasion.avoids(memory, scanner, percept.ranges(k_scanner), random, actions.command)) return;
  if (!puck) {
    actions.command = {k_cruise, 0, 0};
    return;
  }
  memory.avoid_updates = 0;
  const double turn = k_turn_gain * puck->bearing;
  const double speed = is_near ? k_creep : k_cruise;
  actions.command = {std::abs(puck->bearing) < k_aligned ? speed : 0, 0, turn};
}

void Collector::grip(Memory& memory, const engine::Percept& percept, engine::Actions& actions) const {
  const auto& gripper = percept.devices[k_gripper].as<GripperState>();
  actions.command = {};
  order(actions) = GripperCommand::close;
  if (gripper.held != 0) {
    enter(memory, carrying);
    memory.goal = nearest(sinks, percept.estimate.position());
  } else if (gripper.taken != 0 || gripper.paddles == GripperState::closed ||
             memory.updates > decisions_for(k_patience_s, percept.period_s)) {
    enter(memory, leaving);
  }
}

/// Backs off from a sink or a charger and then turns, so that the robot does not drive back to this place.
void Collector::leave(Memory& memory, const engine::Percept& percept, Random& random,
                      engine::Actions& actions) {
  order(actions) = GripperCommand::open;
  actions.command = {-k_creep, 0, 0};
  if (memory.updates <= decisions_for(k_back_off_s, percept.period_s)) return;
  actions.command = {0, 0, memory.goal % 2 == 0 ? 0.8 : -0.8};
  if (memory.avoid_updates < 1)
    memory.avoid_updates =
        static_cast<std::int32_t>(random_decisions(k_turn_s, k_more_turn_s, percept.period_s, random));
  if (--memory.avoid_updates == 0) enter(memory, seeking);
}

void Collector::head_for(const Vec2& goal, Memory& memory, const engine::Percept& percept, Random& random,
                         engine::Actions& actions) const {
  if (evasion.avoids(memory, scanner, percept.ranges(k_scanner), random, actions.command)) return;
  const double off = bearing_of(percept.estimate, goal);
  actions.command = {std::abs(off) < k_drive_within ? k_cruise : 0, 0, k_turn_gain * off};
}

}  // namespace

engine::ControllerKind collector_controller() {
  return engine::make_controller_kind<Collector>(
      "collector",
      "grip pucks, which a fiducial finder recognises, carry them to the nearest sink, and charge the power "
      "pack when it is low");
}

}  // namespace troupe::models
