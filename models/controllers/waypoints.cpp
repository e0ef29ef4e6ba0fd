#include "models/controllers/waypoints.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/spec/world_spec.hpp"
#include "models/controllers/drive_period.hpp"
#include "models/drives/drives.hpp"
#include "models/drives/wheels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

namespace troupe::models {
namespace {

constexpr std::string_view k_name = "waypoints";

// A robot has arrived at a tracked goal (Goal::is_tracked) if it is within this distance (m) and angle (rad).
// The tolerance covers the rounding error of its last step.
constexpr double k_there = 1e-6;

struct Goal {
  Pose pose;
  double at_s = 0;
  double speed = 0;
  double wait_s = 0;

  static constexpr void describe(engine::Description<Goal>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.part<&Goal::pose>();
    d.member<&Goal::at_s>(
        "at", seconds, within(0, engine::k_most_seconds),
        "time at which the robot is to arrive, counted from tick 0 or, with `again`, from the start of the "
        "present round of the goals; it needs an `omni` drive; 0: no time is set");
    d.member<&Goal::speed>(
        "speed", meters_per_second, within(0, 1e6),
        "speed at which the robot moves straight to the goal; it needs an `omni` drive; 0: `at` determines "
        "the speed; if `at` is also 0, the drive determines the path and the speed "
        "(docs/driving.md)");
    d.member<&Goal::wait_s>(
        "wait", seconds, within(0, engine::k_most_seconds),
        "how long the robot waits at the goal before it goes on; if it is moved away from the goal "
        "meanwhile, it returns and waits again");
  }
  /// Whether the goal gives a time or a speed. The robot moves to tracked goals in a straight line. To other
  /// goals it moves as its drive does in the control mode `position` (docs/driving.md).
  bool is_tracked() const { return at_s > 0 || speed > 0; }
};

struct Waypoints {
  struct Memory {
    std::uint32_t goal = 0;    ///< index of the present goal
    std::uint64_t begun = 0;   ///< tick at which the present round began, if goals have times
    std::uint64_t leaves = 0;  ///< while the robot waits: the tick at which it goes on; else 0
    TROUPE_FIELDS(goal, begun, leaves)
  };

  struct Params {
    std::vector<Goal> goals;
    double near = 0.1;
    bool again = false;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::goals>(
          "goals", required,
          "goals in the order in which the robot visits them, in the frame of its estimated pose");
      // `near` is at least 0.03 m, because drives stop within 0.02 m of a goal in x and in y.
      d.member<&Params::near>("near", meters, at_least(0.03),
                              "the robot has reached a goal that has neither `at` nor `speed` when its "
                              "estimated pose is within this distance of the goal");
      d.member<&Params::again>("again",
                               "true: after the last goal the robot starts again with the first; false: it "
                               "stays at the last goal");
    }
  };

  Params params;
  // Limits of the drive, which bind_world() sets if any goal is tracked:
  double speed_max = 0;      // greatest speed that the drive reaches in every direction, m/s
  double turn_max = 0;       // greatest turn rate that the drive reaches to both sides, rad/s
  std::uint64_t period = 1;  // ticks between two runs of the drive
  std::uint64_t steps = 1;   // motions between two runs: one per tick, or a single one of a part with wheels

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) const {
    if (params.goals.empty()) return Error{"needs at least one goal in `goals`"};
    return std::vector<std::size_t>();
  }

  Result<> bind_world(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
    period = drive_period(world, type, part);
    const engine::DeviceSpec* wheels = wheels_of(type, part);
    steps = wheels ? 1 : period;
    if (std::ranges::none_of(params.goals, &Goal::is_tracked)) return {};
    const std::string_view kind = wheels       ? drive_of_wheels(wheels->params).kind
                                  : type.drive ? std::string_view(type.drive->kind)
                                               : std::string_view();
    if (kind != omni_drive().name)
      return Error{fmt::format(
          "has goals with `at` or `speed`, which need a drive of kind \"omni\", found {}: other drives "
          "do not move straight to a goal",
          kind.empty() ? "no drive" : fmt::format("\"{}\"", kind))};
    if (const std::uint64_t decides = decision_period(world, type, part); decides != period)
      return Error{
          fmt::format("has goals with `at` or `speed`, which need wheels that run once per decision, but "
                      "\"{}\" runs every "
                      "{:g} s and the controller decides every {:g} s: give both the same `period`",
                      wheels->name, static_cast<double>(period) * world.tick_s,
                      static_cast<double>(decides) * world.tick_s)};
    const MotionParams motion = wheels ? drive_of_wheels(wheels->params).motion
                                       : engine::from_record<DriveParams>(type.drive->params).motion;
    speed_max = std::min(
        {motion.velocity_max_x, -motion.velocity_min_x, motion.velocity_max_y, -motion.velocity_min_y});
    turn_max = std::min(motion.turn_max, -motion.turn_min);
    if (!(speed_max > 0 && turn_max > 0))
      return Error{
          "has goals with `at` or `speed`, which need a drive that can move and turn in every direction: "
          "give velocity_min_x, velocity_min_y and turn_min below 0, and velocity_max_x, velocity_max_y and "
          "turn_max above 0"};
    for (std::size_t i = 0; i < params.goals.size(); ++i)
      if (const Result<> kept = can_keep(i); !kept)
        return Error{fmt::format("cannot follow goal {} (counted from 1): {}", i + 1, kept.error().text)};
    return {};
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random&, engine::Actions& actions) const {
    // An intervention may have shortened the list of goals.
    memory.goal = std::min(memory.goal, static_cast<std::uint32_t>(params.goals.size() - 1));
    const Ahead ahead = look_ahead(percept, actions.command);
    if (!has_arrived(memory, percept, ahead))
      memory.leaves = 0;  // also if the robot was pushed away or got other goals while it waited
    else if (waits_no_more(memory, percept, ahead))
      go_on(memory, ahead);
    const Goal& goal = params.goals[memory.goal];
    if (goal.is_tracked())
      track(goal, due(memory, percept), ahead, percept, actions);
    else
      actions.go_to(goal.pose.x, goal.pose.y, goal.pose.heading);
  }

  void lint(const engine::LintView& view) const;

 private:
  /// Ticks from one decision to the next. The controller uses no devices, so it decides when the drive of the
  /// body runs or, without such a drive, once per period of its own.
  static std::uint64_t decision_period(const engine::WorldSpec& world, const engine::TypeSpec& type,
                                       std::uint32_t part) {
    if (type.drive) return engine::period_ticks(type.drive->period_s, world.tick_s);
    const auto is_own = [part](const engine::ControllerSpec& controller) {
      return controller.part == part && controller.kind == k_name;
    };
    const auto own = std::ranges::find_if(type.controllers, is_own);
    return engine::period_ticks(own != type.controllers.end() ? own->period_s : 0, world.tick_s);
  }

  /// The tick in which a command given now first moves the robot, and the estimated pose of the robot at the
  /// start of that tick if nothing blocks the robot before.
  struct Ahead {
    std::uint64_t tick;
    Pose pose;
  };

  /// How a constant velocity v and a constant turn rate move the robot between two runs of the drive. In each
  /// motion the robot moves along a straight line, in the direction that its heading then gives to v. All
  /// motions together take it along a chord: in the direction of v at the heading at the start plus `turn`,
  /// over the distance |v| * time * `share`.
  struct Chord {
    double turn = 0;   // rad
    double share = 1;  // at least 0.6 for a turn by up to pi
  };

  /// The chord for a turn by `turn` (rad) between two runs of the drive.
  Chord chord(double turn) const {
    const double half_step = turn / static_cast<double>(2 * steps);
    if (steps == 1 || half_step == 0) return {};
    // The sum of the unit vectors with the angles 0, a, 2a, ..., (n - 1) a has the angle (n - 1) a / 2 and
    // the length sin(n a / 2) / sin(a / 2).
    const auto n = static_cast<double>(steps);
    return {(n - 1) * half_step, sin(turn / 2) / (n * sin(half_step))};
  }

  Ahead look_ahead(const engine::Percept& percept, const engine::Command& command) const {
    Ahead ahead{percept.tick - 1 + period, percept.estimate};
    if (command.mode != engine::ControlMode::velocity) return ahead;
    const double dt = static_cast<double>(period) * percept.tick_s;
    const Chord moves = chord(command.turn * dt);
    const double m_per_mps = dt * moves.share;
    const Vec2 way =
        Rotation(ahead.pose.heading + moves.turn) * Vec2(command.x * m_per_mps, command.y * m_per_mps);
    ahead.pose.x += way.x();
    ahead.pose.y += way.y();
    ahead.pose.heading += command.turn * dt;
    return ahead;
  }

  /// The tick at whose end the robot is to be at its present goal; 0 if the goal has no time.
  std::uint64_t due(const Memory& memory, const engine::Percept& percept) const {
    const double at_s = params.goals[memory.goal].at_s;
    return at_s > 0 ? memory.begun + engine::ticks_until(at_s, percept.tick_s) : 0;
  }

  bool has_arrived(const Memory& memory, const engine::Percept& percept, const Ahead& ahead) const {
    const Goal& goal = params.goals[memory.goal];
    if (!goal.is_tracked())
      return (goal.pose.position() - percept.estimate.position()).squaredNorm() <= params.near * params.near;
    const double turn = wrap_angle(goal.pose.heading - ahead.pose.heading);
    return ahead.tick >= due(memory, percept) && turn >= -k_there && turn <= k_there &&
           (goal.pose.position() - ahead.pose.position()).squaredNorm() <= k_there * k_there;
  }

  bool is_last(const Memory& memory) const { return !params.again && memory.goal + 1 == params.goals.size(); }

  bool waits_no_more(Memory& memory, const engine::Percept& percept, const Ahead& ahead) const {
    const Goal& goal = params.goals[memory.goal];
    if (!(goal.wait_s > 0) || is_last(memory)) return true;
    if (memory.leaves == 0) memory.leaves = ahead.tick + engine::period_ticks(goal.wait_s, percept.tick_s);
    if (ahead.tick < memory.leaves) return false;
    memory.leaves = 0;
    return true;
  }

  void go_on(Memory& memory, const Ahead& ahead) const {
    if (is_last(memory)) return;
    if (++memory.goal < params.goals.size()) return;
    memory.goal = 0;
    if (std::ranges::any_of(params.goals, [](const Goal& goal) { return goal.at_s > 0; }))
      memory.begun = ahead.tick;
  }

  /// Commands the velocity that takes the robot to a tracked goal: at the speed of the goal or, if the goal
  /// has a time, so that it arrives at the end of the tick `due` (0: no time) or, if the drive has a period,
  /// up to a period earlier. A robot that is late gets its greatest speed.
  void track(const Goal& goal, std::uint64_t due, const Ahead& ahead, const engine::Percept& percept,
             engine::Actions& actions) const {
    const Vec2 way = goal.pose.position() - ahead.pose.position();
    const double turn = wrap_angle(goal.pose.heading - ahead.pose.heading);
    const double step_s = static_cast<double>(period) * percept.tick_s;
    // The robot arrives at the end of a period of the drive. If `due` is within a period, the robot must
    // arrive at the end of the period before.
    const std::uint64_t left = due > ahead.tick ? due - ahead.tick : 0;
    const std::uint64_t left_in_periods = left - left % period;
    double left_s = left > 0 ? static_cast<double>(left_in_periods) * percept.tick_s
                             : std::max(way.norm() / speed_of(goal), (turn < 0 ? -turn : turn) / turn_max);
    left_s = std::max(left_s, step_s);
    const double turn_rate = std::clamp(turn / left_s, -turn_max, turn_max);
    const Chord moves = chord(turn_rate * step_s);
    const double speed = way.norm() / left_s / moves.share;
    const double by = (speed > speed_max ? speed_max / speed : 1) / moves.share;
    const Vec2 velocity =
        Rotation(-ahead.pose.heading - moves.turn) * Vec2(way.x() / left_s * by, way.y() / left_s * by);
    actions.set_speed(velocity.x(), velocity.y(), turn_rate);
  }

  double speed_of(const Goal& goal) const { return goal.speed > 0 ? goal.speed : speed_max; }

  /// Returns an error if goal i (from 0) contradicts itself, or demands more than the drive can do.
  Result<> can_keep(std::size_t i) const {
    const Goal& goal = params.goals[i];
    if (goal.at_s > 0 && goal.speed > 0)
      return Error{"it has both `at` and `speed`; give only one, because the other follows from it"};
    if (goal.speed > speed_max)
      return Error{
          fmt::format("its `speed` is {:g} m/s, but the drive reaches {:g} m/s in its slowest direction: "
                      "give a lower `speed`",
                      goal.speed, speed_max)};
    if (i == 0 || !(goal.at_s > 0)) return {};
    const Goal& before = params.goals[i - 1];
    if (before.at_s > 0 && goal.at_s <= before.at_s)
      return Error{
          fmt::format("its `at` is {:g} s, but that of the goal before it is {:g} s; times must increase",
                      goal.at_s, before.at_s)};
    const double way = (goal.pose.position() - before.pose.position()).norm();
    const double time_s = goal.at_s - before.at_s - before.wait_s;
    if (before.at_s > 0 && way > speed_max * time_s * (1 + 1e-9))
      return Error{fmt::format(
          "it is {:g} m from the goal before it, and the robot has {:g} s for this way, from the `at` plus "
          "`wait` of the goal before it to its own `at`, but the drive reaches {:g} m/s in its slowest "
          "direction: give this goal a later `at`",
          way, std::max(time_s, 0.0), speed_max)};
    const double difference = wrap_angle(goal.pose.heading - before.pose.heading);
    const double turn = difference < 0 ? -difference : difference;
    if (before.at_s > 0 && turn > turn_max * time_s * (1 + 1e-9))
      return Error{fmt::format(
          "its heading differs by {:g} rad from that of the goal before it, and the robot has {:g} s for "
          "this turn, from the `at` plus `wait` of the goal before it to its own `at`, but the drive reaches "
          "{:g} rad/s to its slower side: give this goal a later `at`",
          turn, std::max(time_s, 0.0), turn_max)};
    return {};
  }
};

/// Warns of the first goal that is outside of the bounds of the world by more than `near`. Odometry may place
/// a goal anywhere, a part with `wheels` may leave the bounds, and an intervention may give other goals
/// before the robot is to reach these.
void Waypoints::lint(const engine::LintView& view) const {
  const std::optional<engine::BodyType::Drive>& drive = view.body_type().drive;
  if (!view.world.spec.bounds || !drive || drive->localization.kind != engine::Localization::Kind::gps ||
      view.controller().drive || view.is_set({"goals", "near"}))
    return;
  const Box& bounds = *view.world.spec.bounds;
  const Box reached = bounds.expanded(params.near);
  for (std::size_t i = 0; i < params.goals.size(); ++i) {
    const Vec2 at = compose(drive->localization.origin.value_or(Pose()), params.goals[i].pose).position();
    if (reached.contains(at)) continue;
    return view.warn(
        engine::LintTopic::goal,
        fmt::format("{} never reaches its goal {} (counted from 1): the goal is at ({:.4g}, {:.4g}) m, "
                    "outside of the bounds of the world, ({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) m",
                    engine::device_text("the controller", view.controller_spec().kind, view.type_spec().name),
                    i + 1, at.x(), at.y(), bounds.min.x(), bounds.min.y(), bounds.max.x(), bounds.max.y()));
  }
}

}  // namespace

engine::ControllerKind waypoints_controller() {
  engine::ControllerKind kind =
      engine::make_controller_kind<Waypoints>(k_name, "drive from goal to goal, using the estimated pose");
  for (engine::StateField& field : kind.memory) field.sparse = field.name != "goal";
  return kind;
}

}  // namespace troupe::models
