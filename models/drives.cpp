#include "models/drives.hpp"

#include "base/math.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace troupe::models {
namespace {

using engine::Command;
using engine::FieldTable;
using engine::Record;
using engine::Unit;
using engine::Velocity;

struct Drive {
  double x_min, x_max;
  double y_min, y_max;
  double turn_min, turn_max;
  double wheelbase = 1;
};

FieldTable drive_fields() {
  const double k_quarter_turn = radians(90);
  return {{
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
  }};
}

FieldTable car_fields() {
  FieldTable table = drive_fields();
  table.fields.push_back({.name = "wheelbase",
                          .unit = Unit::meters,
                          .fallback = 1.0,
                          .min = 0,
                          .text = "distance between the axles",
                          .above_min = true});
  return table;
}

Drive read(const Record& params, bool car) {
  Drive d{params[0].number(), params[1].number(), params[2].number(),
          params[3].number(), params[4].number(), params[5].number()};
  if (car) d.wheelbase = params[6].number();
  return d;
}

std::string fault(const Record& params) {
  constexpr std::pair<std::size_t, std::string_view> k_bounds[] = {
      {0, "velocity_x"}, {2, "velocity_y"}, {4, "turn"}};
  for (const auto& [low, name] : k_bounds)
    if (params[low].number() > params[low + 1].number())
      return fmt::format("the bounds of {} stand the wrong way round: the lower must come first", name);
  return {};
}

std::any prepare_simple(const Record& params) { return read(params, false); }
std::any prepare_car(const Record& params) { return read(params, true); }

// Not std::clamp: NaN must stay NaN, for the step to name the robot.
double bounded(double v, double low, double high) { return v < low ? low : v > high ? high : v; }

Velocity bounded(const Drive& d, double x, double y, double turn) {
  return {bounded(x, d.x_min, d.x_max), bounded(y, d.y_min, d.y_max), bounded(turn, d.turn_min, d.turn_max)};
}

template <class Law>
void drive_all(const std::any& data, std::span<const Command> commands, std::span<Velocity> velocities,
               Law law) {
  const Drive& d = *std::any_cast<Drive>(&data);
  for (std::size_t i = 0; i < commands.size(); ++i) velocities[i] = law(d, commands[i]);
}

void drive_diff(const std::any& data, std::span<const Command> commands, std::span<Velocity> velocities) {
  drive_all(data, commands, velocities,
            [](const Drive& d, const Command& c) { return bounded(d, c.x, 0, c.turn); });
}
void drive_omni(const std::any& data, std::span<const Command> commands, std::span<Velocity> velocities) {
  drive_all(data, commands, velocities,
            [](const Drive& d, const Command& c) { return bounded(d, c.x, c.y, c.turn); });
}
void drive_car(const std::any& data, std::span<const Command> commands, std::span<Velocity> velocities) {
  drive_all(data, commands, velocities, [](const Drive& d, const Command& c) {
    const SinCos steering = sincos(c.turn);
    return bounded(d, c.x * steering.cos, 0, c.x * steering.sin / d.wheelbase);
  });
}

}  // namespace

engine::DriveKind diff_drive() {
  return {.name = "diff",
          .text = "two driven wheels: forward speed and turn rate",
          .params = drive_fields(),
          .prepare = prepare_simple,
          .fault = fault,
          .drive = drive_diff};
}

engine::DriveKind omni_drive() {
  return {.name = "omni",
          .text = "holonomic: forward and sideways speed and turn rate",
          .params = drive_fields(),
          .prepare = prepare_simple,
          .fault = fault,
          .drive = drive_omni};
}

engine::DriveKind car_drive() {
  return {.name = "car",
          .text = "front wheels that steer: speed and steering angle",
          .params = car_fields(),
          .prepare = prepare_car,
          .fault = fault,
          .drive = drive_car};
}

}  // namespace troupe::models
