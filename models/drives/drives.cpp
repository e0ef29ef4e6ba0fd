#include "models/drives/drives.hpp"

#include "base/pose.hpp"
#include "engine/conflicts.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe::models {
namespace {

using engine::Command;
using engine::ControlMode;
using engine::FieldTable;
using engine::Record;
using engine::Unit;
using engine::Velocity;

struct Bounds {
  double min, max;
};

struct Drive {
  Bounds x, y, turn;                 // m/s, rad/s
  Bounds x_rate, y_rate, turn_rate;  // m/s^2, rad/s^2
  Velocity start;
  double wheelbase = 1;
};

// How robots go to a goal: Stage's numbers.
constexpr double k_go_to_speed = 0.4;      // m/s
constexpr double k_go_to_turn = 1;         // rad/s
constexpr double k_arrived_m = 0.02;       // along both axes
constexpr double k_heads_for = k_pi / 16;  // rad: a diff drives on once the goal lies within this
constexpr double k_car_steers = 2;         // 1/s: a car turns by this much of what it is off course

constexpr std::string_view k_pushes = "pushes";

/// What any drive takes: at the end localization_fields().
std::vector<engine::Field> drive_fields() {
  constexpr double k_quarter_turn = radians(90);
  std::vector<engine::Field> fields{
      {.name = "velocity_min_x", .unit = Unit::meters_per_second, .fallback = -1.0, .text = "backward limit"},
      {.name = "velocity_max_x", .unit = Unit::meters_per_second, .fallback = 1.0, .text = "forward limit"},
      {.name = "velocity_min_y",
       .unit = Unit::meters_per_second,
       .fallback = -1.0,
       .text = "rightward limit"},
      {.name = "velocity_max_y", .unit = Unit::meters_per_second, .fallback = 1.0, .text = "leftward limit"},
      {.name = "turn_min",
       .unit = Unit::radians_per_second,
       .fallback = -k_quarter_turn,
       .text = "clockwise limit"},
      {.name = "turn_max",
       .unit = Unit::radians_per_second,
       .fallback = k_quarter_turn,
       .text = "counter-clockwise limit"},
      {.name = "acceleration_min_x",
       .unit = Unit::meters_per_second_squared,
       .fallback = -1.0,
       .text = "least commanded acceleration forward"},
      {.name = "acceleration_max_x",
       .unit = Unit::meters_per_second_squared,
       .fallback = 1.0,
       .text = "greatest forward"},
      {.name = "acceleration_min_y",
       .unit = Unit::meters_per_second_squared,
       .fallback = -1.0,
       .text = "least to the left"},
      {.name = "acceleration_max_y",
       .unit = Unit::meters_per_second_squared,
       .fallback = 1.0,
       .text = "greatest to the left"},
      {.name = "turn_acceleration_min",
       .unit = Unit::radians_per_second_squared,
       .fallback = -k_quarter_turn,
       .text = "least of the turn rate"},
      {.name = "turn_acceleration_max",
       .unit = Unit::radians_per_second_squared,
       .fallback = k_quarter_turn,
       .text = "greatest of the turn rate"},
      {.name = "start_x",
       .unit = Unit::meters_per_second,
       .fallback = 0.0,
       .text = "speed forward until the drive is due for the first time, not limited"},
      {.name = "start_y", .unit = Unit::meters_per_second, .fallback = 0.0, .text = "the same to the left"},
      {.name = "start_turn",
       .unit = Unit::radians_per_second,
       .fallback = 0.0,
       .text = "the same of the turn"},
  };
  fields.push_back({.name = k_pushes,
                    .type = engine::FieldType::integer,
                    .fallback = std::int64_t{4},
                    .min = 0,
                    .max = engine::k_most_pushed,
                    .text = "how many pushable bodies it pushes at once; more stop it"});
  for (engine::Field& field : engine::localization_fields()) fields.push_back(std::move(field));
  return fields;
}

const FieldTable& drive_table() {
  static const FieldTable table{drive_fields()};
  return table;
}

const FieldTable& car_table() {
  static const FieldTable table = [] {
    FieldTable fields{{{.name = "wheelbase",
                        .unit = Unit::meters,
                        .fallback = 1.0,
                        .min = 0,
                        .text = "distance between the axles",
                        .above_min = true}}};
    for (engine::Field& field : drive_fields()) fields.fields.push_back(std::move(field));
    return fields;
  }();
  return table;
}

Drive read(const FieldTable& table, const Record& params) {
  const auto number = [&](std::string_view name) { return engine::get(table, params, name).number(); };
  const auto bounds = [&](std::string_view low, std::string_view high) {
    return Bounds{number(low), number(high)};
  };
  return {.x = bounds("velocity_min_x", "velocity_max_x"),
          .y = bounds("velocity_min_y", "velocity_max_y"),
          .turn = bounds("turn_min", "turn_max"),
          .x_rate = bounds("acceleration_min_x", "acceleration_max_x"),
          .y_rate = bounds("acceleration_min_y", "acceleration_max_y"),
          .turn_rate = bounds("turn_acceleration_min", "turn_acceleration_max"),
          .start = {number("start_x"), number("start_y"), number("start_turn")},
          .wheelbase = table.find("wheelbase") < 0 ? 1 : number("wheelbase")};
}

Result<> check(const FieldTable& table, const Record& params) {
  constexpr std::array<std::array<std::string_view, 3>, 6> k_bounds{{
      {"velocity_min_x", "velocity_max_x", "velocity_x"},
      {"velocity_min_y", "velocity_max_y", "velocity_y"},
      {"turn_min", "turn_max", "turn"},
      {"acceleration_min_x", "acceleration_max_x", "acceleration_x"},
      {"acceleration_min_y", "acceleration_max_y", "acceleration_y"},
      {"turn_acceleration_min", "turn_acceleration_max", "turn_acceleration"},
  }};
  for (const auto& [low, high, name] : k_bounds)
    if (engine::get(table, params, low).number() > engine::get(table, params, high).number())
      return Error{
          fmt::format("the bounds of {} stand the wrong way round: the lower must come first", name)};
  return {};
}

// Not std::clamp: NaN must stay NaN, for the step to name the robot.
double bounded(double v, const Bounds& bounds) {
  return v < bounds.min ? bounds.min : v > bounds.max ? bounds.max : v;
}
double bounded(double v, double most) { return bounded(v, Bounds{-most, most}); }

Velocity bounded(const Drive& d, double x, double y, double turn) {
  return {bounded(x, d.x), bounded(y, d.y), bounded(turn, d.turn)};
}

/// Speeds proportional to what is missing, 1/s, but where the drive is so rarely due that it would overshoot.
double gain(double most, double elapsed_s) { return most * elapsed_s > 1 ? 1 / elapsed_s : most; }

/// What is missing to the goal.
struct Missing {
  double x, y;      // m, frame of the estimate
  double distance;  // m
  double turn;      // rad, to the goal's heading
  bool arrived;     // but for the heading

  Missing(const Command& goal, const Pose& at)
      : x(goal.x - at.x),
        y(goal.y - at.y),
        distance(sqrt(x * x + y * y)),
        turn(wrap_angle(goal.turn - at.heading)),
        arrived(x > -k_arrived_m && x < k_arrived_m && y > -k_arrived_m && y < k_arrived_m) {}
  /// By how much the robot must turn to face the goal.
  double off_course(const Pose& at) const { return wrap_angle(atan2(y, x) - at.heading); }
};

struct Diff {
  static Velocity speed(const Drive& d, const Command& c) { return bounded(d, c.x, 0, c.turn); }
  static Velocity accelerate(const Drive& d, const Command& c, const Velocity& v, double dt) {
    return bounded(d, v.x + bounded(c.x, d.x_rate) * dt, 0, v.turn + bounded(c.turn, d.turn_rate) * dt);
  }
  /// Turns towards the goal, drives there, turns to its heading.
  static Velocity go_to(const Drive& d, const Command& c, const Pose& at, double dt) {
    const Missing missing(c, at);
    const double k = gain(1, dt);
    if (missing.arrived) return bounded(d, 0, 0, bounded(k * missing.turn, k_go_to_turn));
    const double turn = missing.off_course(at);
    const bool faces_it = turn > -k_heads_for && turn < k_heads_for;
    return bounded(d, faces_it ? bounded(k * missing.distance, k_go_to_speed) : 0, 0,
                   bounded(k * turn, k_go_to_turn));
  }
};

struct Omni {
  static Velocity speed(const Drive& d, const Command& c) { return bounded(d, c.x, c.y, c.turn); }
  static Velocity accelerate(const Drive& d, const Command& c, const Velocity& v, double dt) {
    return bounded(d, v.x + bounded(c.x, d.x_rate) * dt, v.y + bounded(c.y, d.y_rate) * dt,
                   v.turn + bounded(c.turn, d.turn_rate) * dt);
  }
  /// Straight there, turning on the way.
  static Velocity go_to(const Drive& d, const Command& c, const Pose& at, double dt) {
    const Missing missing(c, at);
    const double k = gain(1, dt);
    const Vec2 way = Rotation(-at.heading) * Vec2(missing.x, missing.y);
    return bounded(d, bounded(k * way.x(), k_go_to_speed), bounded(k * way.y(), k_go_to_speed),
                   bounded(k * missing.turn, k_go_to_turn));
  }
};

struct Car {
  /// Of the front wheels: their speed and steering angle make the car's.
  static Velocity steer(const Drive& d, double speed, double angle) {
    const SinCos steering = sincos(angle);
    return bounded(d, speed * steering.cos, 0, speed * steering.sin / d.wheelbase);
  }
  static Velocity speed(const Drive& d, const Command& c) { return steer(d, c.x, c.turn); }
  /// Accelerates the front wheels, which roll as fast as the last tick's motion says.
  static Velocity accelerate(const Drive& d, const Command& c, const Velocity& v, double dt) {
    const double across = v.turn * d.wheelbase;
    const double rolling = sqrt(v.x * v.x + across * across);
    return steer(d, (v.x < 0 ? -rolling : rolling) + bounded(c.x, d.x_rate) * dt, c.turn);
  }
  /// Drives in a curve towards a goal before it; with the front wheels across it swings about its rear axle
  /// towards one behind it, and to the goal's heading in the end.
  static Velocity go_to(const Drive& d, const Command& c, const Pose& at, double dt) {
    const Missing missing(c, at);
    const double k = gain(1, dt);
    if (missing.arrived) return bounded(d, 0, 0, bounded(k * missing.turn, k_go_to_turn));
    const double turn = missing.off_course(at);
    const double ahead = cos(turn);
    return bounded(d, ahead > 0 ? bounded(k * missing.distance, k_go_to_speed) * ahead : 0, 0,
                   bounded(gain(k_car_steers, dt) * turn, k_go_to_turn));
  }
};

template <class Law>
void drive_all(const std::any& data, const engine::DriveBatch& batch) {
  const Drive& d = *std::any_cast<Drive>(&data);
  if (batch.estimates.empty()) {
    for (std::size_t i = 0; i < batch.commands.size(); ++i)
      batch.velocities[i] = Law::speed(d, batch.commands[i]);
    return;
  }
  for (std::size_t i = 0; i < batch.commands.size(); ++i) {
    const Command& command = batch.commands[i];
    Velocity& v = batch.velocities[i];
    switch (command.mode) {
      case ControlMode::velocity: v = Law::speed(d, command); break;
      case ControlMode::acceleration: v = Law::accelerate(d, command, v, batch.elapsed_s); break;
      case ControlMode::position: v = Law::go_to(d, command, batch.estimates[i], batch.elapsed_s); break;
    }
  }
}

const FieldTable& table_of(bool car) { return car ? car_table() : drive_table(); }

template <class Law>
engine::DriveKind make_drive(std::string_view name, std::string_view text) {
  constexpr bool k_is_car = std::is_same_v<Law, Car>;
  const FieldTable& table = table_of(k_is_car);
  return {.name = name,
          .text = text,
          .params = table,
          .prepare = [](const Record& params) { return std::any(read(table_of(k_is_car), params)); },
          .check = [](const Record& params) { return check(table_of(k_is_car), params); },
          .drive = drive_all<Law>,
          .start = [](const std::any& data) { return std::any_cast<const Drive&>(data).start; },
          .localization = table.fields.size() - engine::localization_fields().size(),
          .pushes = static_cast<std::size_t>(table.find(k_pushes))};
}

}  // namespace

engine::DriveKind diff_drive() {
  return make_drive<Diff>("diff", "two driven wheels: forward speed and turn rate");
}

engine::DriveKind omni_drive() {
  return make_drive<Omni>("omni", "holonomic: forward and sideways speed and turn rate");
}

engine::DriveKind car_drive() {
  return make_drive<Car>("car", "front wheels that steer: speed and steering angle");
}

}  // namespace troupe::models
