#include "models/drives/drives.hpp"

#include "base/pose.hpp"
#include "engine/kinds/make_drive_kind.hpp"
#include "engine/observing/lint_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace troupe::models {
namespace {

using engine::Command;
using engine::ControlMode;
using engine::Velocity;

struct Bounds {
  double min, max;

  double largest() const { return std::max(std::abs(min), std::abs(max)); }
};

struct Drive {
  Bounds x, y, turn;                 // m/s, rad/s
  Bounds x_rate, y_rate, turn_rate;  // m/s^2, rad/s^2
  double goal_speed, goal_turn;      // greatest speeds on the way to a goal, m/s, rad/s
  Velocity start;
  double wheelbase = 1;
};

// Constants of driving to a goal, from Stage.
constexpr double k_arrived_m = 0.02;       // the robot has arrived if it is this near the goal in x and in y
constexpr double k_heads_for = k_pi / 16;  // rad: a diff drives while the bearing of the goal is below this
constexpr double k_car_steers = 2;         // 1/s: gain from the bearing of the goal to a car's turn rate

Drive drive_of(const DriveParams& params, double wheelbase = 1) {
  const MotionParams& m = params.motion;
  return {.x = {m.velocity_min_x, m.velocity_max_x},
          .y = {m.velocity_min_y, m.velocity_max_y},
          .turn = {m.turn_min, m.turn_max},
          .x_rate = {m.acceleration_min_x, m.acceleration_max_x},
          .y_rate = {m.acceleration_min_y, m.acceleration_max_y},
          .turn_rate = {m.turn_acceleration_min, m.turn_acceleration_max},
          .goal_speed = params.goal.speed_max,
          .goal_turn = params.goal.turn_max,
          .start = {params.start.x, params.start.y, params.start.turn},
          .wheelbase = wheelbase};
}
Drive drive_of(const CarParams& params) { return drive_of(params.drive, params.wheelbase); }

// This is not std::clamp, whose result is undefined for NaN. NaN must stay NaN, so that the engine can report
// the robot whose command is not a number.
double bounded(double v, const Bounds& bounds) {
  return v < bounds.min ? bounds.min : v > bounds.max ? bounds.max : v;
}
double bounded(double v, double most) { return bounded(v, Bounds{-most, most}); }

Velocity bounded(const Drive& d, double x, double y, double turn) {
  return {bounded(x, d.x), bounded(y, d.y), bounded(turn, d.turn)};
}

/// Gain of the proportional control, 1/s: `most`, or less if the drive runs so rarely that `most` would
/// overshoot the goal. elapsed_s: time between two runs of the drive.
double gain(double most, double elapsed_s) { return most * elapsed_s > 1 ? 1 / elapsed_s : most; }

/// The remaining way to a goal.
struct Missing {
  double x, y;      // m, in the frame in which the pose is estimated
  double distance;  // m
  double turn;      // angle from the robot's heading to the goal's heading, rad
  bool arrived;     // the robot has reached the position of the goal; its heading may differ

  Missing(const Command& goal, const Pose& at)
      : x(goal.x - at.x),
        y(goal.y - at.y),
        distance(sqrt(x * x + y * y)),
        turn(wrap_angle(goal.turn - at.heading)),
        arrived(x > -k_arrived_m && x < k_arrived_m && y > -k_arrived_m && y < k_arrived_m) {}
  /// Angle by which the robot at the pose `at` must turn to face the goal, rad.
  double off_course(const Pose& at) const { return wrap_angle(atan2(y, x) - at.heading); }
};

struct Diff {
  static double top_speed(const Drive& d) { return d.x.largest(); }
  static Velocity speed(const Drive& d, const Command& c) { return bounded(d, c.x, 0, c.turn); }
  static Velocity accelerate(const Drive& d, const Command& c, const Velocity& v, double dt) {
    return bounded(d, v.x + bounded(c.x, d.x_rate) * dt, 0, v.turn + bounded(c.turn, d.turn_rate) * dt);
  }
  /// Velocity on the way to the goal `c` from the pose `at`. The robot turns towards the goal, drives to it,
  /// and then turns to the goal's heading. dt: time between two runs of the drive, s.
  static Velocity go_to(const Drive& d, const Command& c, const Pose& at, double dt) {
    const Missing missing(c, at);
    const double k = gain(1, dt);
    if (missing.arrived) return bounded(d, 0, 0, bounded(k * missing.turn, d.goal_turn));
    const double turn = missing.off_course(at);
    const bool faces_it = turn > -k_heads_for && turn < k_heads_for;
    return bounded(d, faces_it ? bounded(k * missing.distance, d.goal_speed) : 0, 0,
                   bounded(k * turn, d.goal_turn));
  }
};

struct Omni {
  static double top_speed(const Drive& d) { return Vec2(d.x.largest(), d.y.largest()).norm(); }
  static Velocity speed(const Drive& d, const Command& c) { return bounded(d, c.x, c.y, c.turn); }
  static Velocity accelerate(const Drive& d, const Command& c, const Velocity& v, double dt) {
    return bounded(d, v.x + bounded(c.x, d.x_rate) * dt, v.y + bounded(c.y, d.y_rate) * dt,
                   v.turn + bounded(c.turn, d.turn_rate) * dt);
  }
  /// Velocity on the way to the goal `c` from the pose `at`. The robot drives towards the goal, straight once
  /// neither speed is clamped, and turns to the goal's heading on the way. dt: time between two runs of the
  /// drive, s.
  static Velocity go_to(const Drive& d, const Command& c, const Pose& at, double dt) {
    const Missing missing(c, at);
    const double k = gain(1, dt);
    const Vec2 way = Rotation(-at.heading) * Vec2(missing.x, missing.y);
    return bounded(d, bounded(k * way.x(), d.goal_speed), bounded(k * way.y(), d.goal_speed),
                   bounded(k * missing.turn, d.goal_turn));
  }
};

struct Car {
  static double top_speed(const Drive& d) { return d.x.largest(); }
  /// The velocity of the car whose front wheels have this speed (m/s) and steering angle (rad).
  static Velocity steer(const Drive& d, double speed, double angle) {
    const SinCos steering = sincos(angle);
    return bounded(d, speed * steering.cos, 0, speed * steering.sin / d.wheelbase);
  }
  static Velocity speed(const Drive& d, const Command& c) { return steer(d, c.x, c.turn); }
  /// The velocity of the car after its front wheels have accelerated by c.x (m/s^2) for dt seconds, with the
  /// steering angle c.turn (rad). The speed of the wheels before is computed from the last velocity v; its
  /// sign follows from v.x, because wheels that point backwards roll forward while the car drives backwards.
  static Velocity accelerate(const Drive& d, const Command& c, const Velocity& v, double dt) {
    const double across = v.turn * d.wheelbase;
    const double rolling = sqrt(v.x * v.x + across * across);
    const SinCos steering = sincos(c.turn);
    const double along = v.x != 0 ? v.x * steering.cos : across * steering.sin;
    return steer(d, (along < 0 ? -rolling : rolling) + bounded(c.x, d.x_rate) * dt, c.turn);
  }
  /// Velocity on the way to the goal `c` from the pose `at`. The car drives in a curve towards a goal ahead.
  /// If the goal is behind the car, the car swings about its rear axle towards the goal, with the front
  /// wheels at a right angle. After arrival it swings to the goal's heading. dt: time in s between two runs
  /// of the drive.
  static Velocity go_to(const Drive& d, const Command& c, const Pose& at, double dt) {
    const Missing missing(c, at);
    const double k = gain(1, dt);
    if (missing.arrived) return bounded(d, 0, 0, bounded(k * missing.turn, d.goal_turn));
    const double turn = missing.off_course(at);
    const double ahead = cos(turn);
    return bounded(d, ahead > 0 ? bounded(k * missing.distance, d.goal_speed) * ahead : 0, 0,
                   bounded(gain(k_car_steers, dt) * turn, d.goal_turn));
  }
};

/// Warns of a drive whose limits exclude 0, so that the robot moves although its command is 0, and of a drive
/// that drives backwards but never forwards. rest, forwards, backwards: the velocities for the command 0 and
/// for great speeds
void lint_limits(const engine::LintView& view, const Velocity& rest, const Velocity& forwards,
                 const Velocity& backwards) {
  if (view.is_set(
          {"velocity_min_x", "velocity_max_x", "velocity_min_y", "velocity_max_y", "turn_min", "turn_max"}))
    return;
  std::string moves;
  const auto add = [&](std::string_view what, double speed, std::string_view unit) {
    if (speed != 0)
      moves += fmt::format("{}a {} of {:.10g} {}", moves.empty() ? "" : " and ", what, speed, unit);
  };
  add("forward speed", rest.x, "m/s");
  add("speed to the left", rest.y, "m/s");
  add("turn rate", rest.turn, "rad/s");
  const std::string drive =
      engine::device_text("the drive", view.body_type().drive->kind->name, view.body_type().name);
  if (!moves.empty())
    view.warn(engine::LintTopic::drive,
              fmt::format("{} cannot stand still: if the command is 0, its limits give {}", drive, moves));
  else if (forwards.x == 0 && backwards.x < 0)
    view.warn(engine::LintTopic::drive,
              drive + " can only drive backwards: its limits exclude forward speeds");
}

const DriveParams& common(const DriveParams& params) { return params; }
const DriveParams& common(const CarParams& params) { return params.drive; }

template <class Law, class ItsParams>
struct Driving {
  using Params = ItsParams;

  Drive its;

  static Driving make(const Params& params) { return {drive_of(params)}; }
  static Result<> check(const Params& params) { return common(params).motion.check(); }
  static Result<engine::Localization> localization(const Params& params) {
    return common(params).localization.read();
  }
  static std::int64_t pushes(const Params& params) { return common(params).pushes; }
  static bool turns_when_blocked(const Params& params) { return common(params).turns_when_blocked; }
  static double top_speed(const Params& params) { return Law::top_speed(drive_of(params)); }

  Velocity start() const { return its.start; }

  void drive(const engine::DriveBatch& batch) const {
    if (batch.estimates.empty()) {
      for (std::size_t i = 0; i < batch.commands.size(); ++i)
        batch.velocities[i] = Law::speed(its, batch.commands[i]);
      return;
    }
    for (std::size_t i = 0; i < batch.commands.size(); ++i) {
      const Command& command = batch.commands[i];
      Velocity& v = batch.velocities[i];
      switch (command.mode) {
        case ControlMode::velocity: v = Law::speed(its, command); break;
        case ControlMode::acceleration: v = Law::accelerate(its, command, v, batch.elapsed_s); break;
        case ControlMode::position: v = Law::go_to(its, command, batch.estimates[i], batch.elapsed_s); break;
      }
    }
  }

  void lint(const engine::LintView& view) const {
    constexpr double k_fast = 1e9;  // m/s
    lint_limits(view, Law::speed(its, {}), Law::speed(its, {k_fast}), Law::speed(its, {-k_fast}));
  }
};

}  // namespace

Result<> MotionParams::check() const {
  struct Limits {
    double low, high;
    std::string_view name;
  };
  for (const Limits& limits :
       {Limits{velocity_min_x, velocity_max_x, "velocity_min_x, velocity_max_x"},
        Limits{velocity_min_y, velocity_max_y, "velocity_min_y, velocity_max_y"},
        Limits{turn_min, turn_max, "turn_min, turn_max"},
        Limits{acceleration_min_x, acceleration_max_x, "acceleration_min_x, acceleration_max_x"},
        Limits{acceleration_min_y, acceleration_max_y, "acceleration_min_y, acceleration_max_y"},
        Limits{turn_acceleration_min, turn_acceleration_max, "turn_acceleration_min, turn_acceleration_max"}})
    if (limits.low > limits.high)
      return Error{
          fmt::format("{}: lower bound {:g} exceeds upper bound {:g}", limits.name, limits.low, limits.high)};
  return {};
}

engine::DriveKind diff_drive() {
  return engine::make_drive_kind<Driving<Diff, DriveParams>>(
      "diff", "two driven wheels: forward speed and turn rate");
}

engine::DriveKind omni_drive() {
  return engine::make_drive_kind<Driving<Omni, DriveParams>>(
      "omni", "holonomic: forward and sideways speed and turn rate");
}

engine::DriveKind car_drive() {
  return engine::make_drive_kind<Driving<Car, CarParams>>("car",
                                                          "steered front wheels: speed and steering angle");
}

}  // namespace troupe::models
