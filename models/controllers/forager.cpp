#include "models/controllers/forager.hpp"

#include "engine/kinds/controller.hpp"
#include "models/controllers/decisions.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/evasion.hpp"
#include "models/controllers/fiducial_readings.hpp"
#include "models/controllers/floor_plan.hpp"
#include "models/devices/flags.hpp"
#include "models/devices/power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace troupe::models {
namespace {

using engine::DeviceInfo;
using engine::WorldSpec;

// Constants from Stage's foragers. Distances in m, speeds in m/s, durations in decisions.
constexpr double k_cruise = 0.4;
constexpr std::uint32_t k_wait = 20;    // time near a source or sink before the robot takes or gives a flag
constexpr double k_fetch_radius = 2;    // a robot is near a source within this distance
constexpr double k_deliver_radius = 1;  // a robot is near a sink within this distance
constexpr double k_full = 0.95;         // charging ends above this fraction of the capacity
constexpr double k_creep_within = 0.5;  // distance to a charger within which the robot drives at k_creep
constexpr double k_creep = 0.02;
constexpr double k_docked = 0.08;   // distance to a charger within which the robot stands still
constexpr double k_back_off = 0.3;  // distance to which a robot backs away from its charger
constexpr double k_back_speed = 0.1;
constexpr double k_abandon = 0.0005;        // probability per decision that a robot gives up waiting
constexpr std::int32_t k_charger_mark = 2;  // fiducial_return of chargers

// Constants that Stage does not have.
constexpr int k_steps_ahead = 2;        // cells of the path from the robot to the point that it heads for
constexpr double k_turn_gain = 1;       // 1/s
constexpr double k_drive_within = 1.0;  // rad: at a larger angle to its path, the robot turns on the spot
constexpr double k_dock_within = 1.5;   // m: nearer to its charger, the robot heads straight for it
constexpr double k_aligned = 0.2;       // rad: bearing of the charger within which the robot faces it
constexpr double k_room = 0.7;          // m: with less room ahead, another robot is at the charger
constexpr double k_queue = 1.2;         // m: waiting robots back off to this distance from the charger
constexpr double k_patience_s = 5;      // s: longest time for which a robot backs away
constexpr double k_least_zone = 1;      // m: least radius of a fuel zone

/// A source, a sink or a charger, and the paths to it.
struct Goal {
  BodyId body;
  Vec2 at;
  std::shared_ptr<const WaysTo> ways;
};
struct Task {
  Goal source, sink;
};

/// Position of a charger relative to the robot, by the robot's fiducial finder or by the world file.
struct Sight {
  double range = 0;    // m
  double bearing = 0;  // rad, from straight ahead
};

struct Forager {
  enum Mode : std::uint8_t { working, refuelling, leaving, to_zone };
  /// Durations are in decisions; a decision is one call of the controller.
  struct Memory {
    std::int32_t avoid_updates = 0;  ///< decisions that remain of the present turn
    /// Consecutive decisions near the source or sink; in the mode `leaving`, decisions of backing away.
    std::uint32_t near_updates = 0;
    std::uint32_t task = 0;            ///< index of the robot's task in `tasks`
    std::uint32_t charger = 0;         ///< index of the robot's charger in `chargers`
    std::uint32_t still_updates = 0;   ///< consecutive decisions in which a command did not move the robot
    std::uint32_t escape_updates = 0;  ///< decisions that remain of backing out
    double x = 0;                      ///< estimated x at the last decision, m
    double y = 0;                      ///< estimated y at the last decision, m
    double heading = 0;                ///< estimated heading at the last decision, rad
    std::uint8_t mode = working;       ///< a Mode
    std::uint8_t started = 0;          ///< 1: a task has been drawn
    TROUPE_FIELDS(avoid_updates, near_updates, task, charger, still_updates, escape_updates, x, y, heading,
                  mode, started)
  };
  static constexpr std::array<std::string_view, 1> brings{"flags"};
  static constexpr std::size_t k_scanner = 0;
  static constexpr std::size_t k_flags = 1;

  std::vector<std::pair<std::string, std::string>> names;  // names of source and sink, per task
  std::string map;                                         // name of the floor plan
  double low = 0;         // a power pack below this fraction of its capacity must be charged
  bool abandons = false;  // true (fasr2): robots may give up waiting, and use the fuel zone
  Scanner scanner;
  Evasion evasion{.min_front = 0.7f, .stop = 0.5f, .back_speed = k_back_speed};
  std::optional<std::size_t> pack, finder;  // indices among the chosen devices
  FiducialReadings sights;                  // reads the fiducial finder
  std::vector<Task> tasks;
  std::vector<Goal> chargers;
  bool has_zone = false;  // whether there is a fuel zone, to which robots go before they choose a charger
  Goal zone;
  double zone_radius = 0;  // m

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed);
  Result<> bind_world(const WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part);
  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const;

 protected:
  Sight charger_in_sight(const Memory& memory, const engine::Percept& percept) const;
  bool is_near_charger(const Memory& memory, const engine::Percept& percept) const {
    return (chargers[memory.charger].at - percept.estimate.position()).norm() < k_dock_within;
  }

 private:
  void work(Memory& memory, const engine::Percept& percept, Random& random, engine::Actions& actions) const;
  void head_for(Memory& memory, const engine::Percept& percept, Random& random, engine::Actions& actions,
                const Goal& goal) const;
  static void follow_way(const Goal& goal, const engine::Percept& percept, engine::Actions& actions);
  void go_to_zone(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const;
  void refuel(Memory& memory, const engine::Percept& percept, Random& random, engine::Actions& actions) const;
  void leave(Memory& memory, const engine::Percept& percept, engine::Actions& actions) const;
  std::uint32_t nearest_charger(const Pose& from) const;
  bool avoids(Memory& memory, const engine::Percept& percept, Random& random, engine::Actions& actions) const;
};

Result<std::vector<std::size_t>> Forager::choose(std::span<const DeviceInfo> devices,
                                                 std::vector<bool>& claimed) {
  DeviceChoice choice(devices, claimed);
  const Result<Scanner> taken = choice.take_scanner(Evasion::window_share);
  if (!taken) return taken.error();
  scanner = *taken;
  if (!choice.take_kind("flags")) return choice.missing("flags", "needs a device of kind \"flags\"");
  const auto last = [&] { return choice.chosen().size() - 1; };
  if (choice.take_kind("power_pack")) pack = last();
  if (choice.take_kind("fiducial")) {
    finder = last();
    sights = FiducialReadings(devices[choice.chosen().back()]);
  }
  return choice.chosen();
}

Result<> Forager::bind_world(const WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
  evasion.drive_period = drive_period(world, type, part);
  const FloorPlan plan = FloorPlan::of_world(world, map);
  const auto goal_at = [&](BodyId body, const Vec2& at) {
    const std::array<int, 1> cells{plan.cell(at)};
    return Goal{body, at, std::make_shared<const WaysTo>(plan, cells)};
  };
  const auto goal = [&](BodyId body) {
    return goal_at(body, world.bodies[body.index()].pose_world_body.position());
  };
  for (const auto& [source, sink] : names) {
    const BodyId from = find_body(world, source);
    const BodyId to = find_body(world, sink);
    if (!from.valid() || !to.valid())
      return Error{fmt::format("needs a model in the world named \"{}\"", from.valid() ? sink : source)};
    tasks.push_back({goal(from), goal(to)});
  }
  if (pack)
    for (const auto& [body, at] : bodies_with_mark(world, k_charger_mark))
      chargers.push_back(goal_at(body, at));
  if (const BodyId body = find_body(world, "fuel_zone"); abandons && body.valid() && !chargers.empty()) {
    has_zone = true;
    zone = goal(body);
    const Eigen::Vector3d& size = world.type(body).parts.front().size;
    zone_radius = std::max(0.5 * std::min(size.x(), size.y()), k_least_zone);
  }
  return {};
}

bool Forager::avoids(Memory& memory, const engine::Percept& percept, Random& random,
                     engine::Actions& actions) const {
  return evasion.avoids(memory, scanner, percept.ranges(k_scanner), random, actions.command);
}

std::uint32_t Forager::nearest_charger(const Pose& from) const {
  const auto distance2 = [&](const Goal& goal) { return (goal.at - from.position()).squaredNorm(); };
  return static_cast<std::uint32_t>(std::ranges::min_element(chargers, {}, distance2) - chargers.begin());
}

/// Position of the nearest charger that the finder sees, relative to the robot. If the robot has no finder or
/// the finder sees no charger: the position in the world file of the charger to which the robot goes.
Sight Forager::charger_in_sight(const Memory& memory, const engine::Percept& percept) const {
  if (finder) {
    const engine::Readings& seen = percept.devices[*finder];
    for (std::size_t i = 0; i < sights.count(seen); ++i)
      if (sights.id(seen, i) == k_charger_mark) return {sights.range(seen, i), sights.bearing(seen, i)};
  }
  const Vec2& at = chargers[memory.charger].at;
  return {(at - percept.estimate.position()).norm(), bearing_of(percept.estimate, at)};
}

void Forager::operator()(Memory& memory, const engine::Percept& percept, Random& random,
                         engine::Actions& actions) const {
  if (memory.started == 0 || memory.task >= tasks.size()) {  // an intervention may have removed tasks
    memory.started = 1;
    memory.task = random.below(static_cast<std::uint32_t>(tasks.size()));
  }
  // A memory from a checkpoint may have any values.
  if (!pack || chargers.empty()) memory.mode = working;
  if (memory.mode == to_zone && !has_zone) memory.mode = refuelling;
  if (memory.charger >= chargers.size()) memory.charger = 0;
  if (memory.mode == working && pack && !chargers.empty() &&
      percept.devices[*pack].as<PowerPackState>().proportion_remaining() < low) {
    memory.mode = has_zone ? to_zone : refuelling;
    memory.near_updates = 0;
    memory.charger = nearest_charger(percept.estimate);
  }
  if (evasion.escapes(memory, percept, random, actions.command)) return;
  switch (memory.mode) {
    case working: return work(memory, percept, random, actions);
    case refuelling: return refuel(memory, percept, random, actions);
    case to_zone: return go_to_zone(memory, percept, random, actions);
    default: return leave(memory, percept, actions);
  }
}

void Forager::head_for(Memory& memory, const engine::Percept& percept, Random& random,
                       engine::Actions& actions, const Goal& goal) const {
  if (!avoids(memory, percept, random, actions)) follow_way(goal, percept, actions);
}

void Forager::follow_way(const Goal& goal, const engine::Percept& percept, engine::Actions& actions) {
  const double off =
      bearing_of(percept.estimate, goal.ways->ahead(percept.estimate.position(), k_steps_ahead));
  actions.command = {std::abs(off) < k_drive_within ? k_cruise : 0, 0, k_turn_gain * off};
}

void Forager::go_to_zone(Memory& memory, const engine::Percept& percept, Random& random,
                         engine::Actions& actions) const {
  if ((zone.at - percept.estimate.position()).norm() < zone_radius) {
    memory.mode = refuelling;
    memory.charger = nearest_charger(percept.estimate);
    return refuel(memory, percept, random, actions);
  }
  head_for(memory, percept, random, actions, zone);
}

void Forager::work(Memory& memory, const engine::Percept& percept, Random& random,
                   engine::Actions& actions) const {
  const bool has_flag = percept.devices[k_flags].field<std::uint32_t>(k_flag_count)[0] > 0;
  const Task& task = tasks[memory.task];
  const Goal& goal = has_flag ? task.sink : task.source;
  const double radius = has_flag ? k_deliver_radius : k_fetch_radius;
  const double away = (goal.at - percept.estimate.position()).norm();
  memory.near_updates = away < radius ? memory.near_updates + 1 : 0;
  if (memory.near_updates > k_wait) {
    memory.near_updates = 0;
    actions.device<FlagCommand>(k_flags).ask(has_flag ? FlagCommand::give : FlagCommand::take,
                                             goal.body.value);
    if (has_flag) memory.task = random.below(static_cast<std::uint32_t>(tasks.size()));
  } else if (abandons && memory.near_updates > 0 && random.uniform() < k_abandon) {
    if (!has_flag) memory.task = random.below(static_cast<std::uint32_t>(tasks.size()));
  }
  if (avoids(memory, percept, random, actions)) return;
  if (away < radius / 2)
    actions.command = {};
  else
    follow_way(goal, percept, actions);
}

void Forager::refuel(Memory& memory, const engine::Percept& percept, Random& random,
                     engine::Actions& actions) const {
  const auto& state = percept.devices[*pack].as<PowerPackState>();
  if (state.proportion_remaining() > k_full) {
    memory.mode = leaving;
    memory.near_updates = 0;
    return leave(memory, percept, actions);
  }
  const Goal& charger = chargers[memory.charger];
  const Sight sight = charger_in_sight(memory, percept);
  if (!is_near_charger(memory, percept)) return head_for(memory, percept, random, actions, charger);
  memory.avoid_updates = 0;
  if (abandons && state.charging == 0 && random.uniform() < k_abandon)
    memory.charger = random.below(static_cast<std::uint32_t>(chargers.size()));
  // The robot does not stop at its first contact with the charger: that would leave no room for other robots.
  if (sight.range < k_docked) {
    actions.command = {};
    return;
  }
  const double turn = k_turn_gain * sight.bearing;
  const bool is_aligned = std::abs(sight.bearing) < k_aligned;
  // Another robot ahead is charging or about to charge. This robot waits and leaves it room to come out.
  const bool is_taken =
      scanner.straight_ahead(percept.ranges(k_scanner)) < k_room && sight.range > k_creep_within;
  if (is_taken)
    actions.command = {is_aligned && sight.range < k_queue ? -k_back_speed : 0, 0, turn};
  else
    actions.command = {!is_aligned ? 0 : sight.range < k_creep_within ? k_creep : 0.5 * k_cruise, 0, turn};
}

void Forager::leave(Memory& memory, const engine::Percept& percept, engine::Actions& actions) const {
  // After k_patience_s the robot works on, even if it could not back away. It then turns on the spot.
  ++memory.near_updates;
  if (charger_in_sight(memory, percept).range > k_back_off ||
      memory.near_updates > decisions_for(k_patience_s, percept.period_s)) {
    memory.mode = working;
    memory.near_updates = 0;
  }
  actions.command = {-k_back_speed, 0, 0};
}

constexpr const char* k_map_text =
    "name of the model around whose walls robots plan their paths; if no model has this name, the first "
    "floor plan in the world is used";

struct Fasr : Forager {
  struct Params {
    std::string source = "source";
    std::string sink = "sink";
    std::string map = "cave";

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::source>("source", "name of the model from which flags are fetched");
      d.member<&Params::sink>("sink", "name of the model to which flags are brought");
      d.member<&Params::map>("map", k_map_text);
    }
  };
  static Fasr make(const Params& params) {
    Fasr forager;
    forager.names = {{params.source, params.sink}};
    forager.map = params.map;
    forager.low = 0.25;
    return forager;
  }
};

/// The controller `fasr2`. It also switches devices. The fiducial finder is on only while the robot goes to a
/// charger, charges and leaves the charger. The scanner is off for the last half metre to a charger and while
/// the robot charges.
struct Fasr2 : Forager {
  struct Params {
    std::string task, task2, task3, task4, task5, task6, task7, task8;
    std::string map = "cave";

    static constexpr void describe(engine::Description<Params>& d) {
      constexpr const char* k_text =
          "name of a task: \"red\" means to carry flags from the model red_source to the model red_sink; "
          "empty: no task";
      d.member<&Params::task>("task", k_text);
      d.member<&Params::task2>("task2", k_text);
      d.member<&Params::task3>("task3", k_text);
      d.member<&Params::task4>("task4", k_text);
      d.member<&Params::task5>("task5", k_text);
      d.member<&Params::task6>("task6", k_text);
      d.member<&Params::task7>("task7", k_text);
      d.member<&Params::task8>("task8", k_text);
      d.member<&Params::map>("map", k_map_text);
    }
  };
  static constexpr bool switches = true;

  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    Forager::operator()(memory, percept, random, actions);
    const bool is_docking = memory.mode == refuelling || memory.mode == leaving;
    // Far from the charger, the last reading of the finder may be old: it may show an earlier charger.
    const bool is_at_charger = memory.mode == refuelling && is_near_charger(memory, percept) &&
                               charger_in_sight(memory, percept).range < k_creep_within;
    actions.switch_device(k_scanner, !is_at_charger);
    if (finder) actions.switch_device(*finder, is_docking);
  }
  static Fasr2 make(const Params& params) {
    Fasr2 forager;
    for (const std::string* task : {&params.task, &params.task2, &params.task3, &params.task4, &params.task5,
                                    &params.task6, &params.task7, &params.task8})
      if (!task->empty()) forager.names.emplace_back(*task + "_source", *task + "_sink");
    forager.map = params.map;
    forager.low = 0.2;
    forager.abandons = true;
    return forager;
  }
  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed) {
    if (names.empty())
      return Error{
          "has no task: give `task`; with the value \"red\", the robot carries flags from the model "
          "red_source to the model red_sink"};
    return Forager::choose(devices, claimed);
  }
};

}  // namespace

engine::ControllerKind fasr_controller() {
  return engine::make_controller_kind<Fasr>(
      "fasr", "fetch flags from a source, bring them to a sink, and charge the power pack when it is low");
}

engine::ControllerKind fasr2_controller() {
  return engine::make_controller_kind<Fasr2>("fasr2",
                                             "fetch flags from several sources, bring them to their sinks, "
                                             "and charge the power pack when it is low");
}

}  // namespace troupe::models
