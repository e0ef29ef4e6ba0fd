#include "engine/localization.hpp"

#include "base/random.hpp"

namespace troupe::engine {
namespace {

// How far odometry is off where the world does not say: Stage's, of which half to either side.
constexpr double k_way_error = 0.03;
constexpr double k_turn_error = 0.05;

const Value* find(const FieldTable& table, const Record& params, std::string_view name) {
  const int at = table.find(name);
  return at < 0 ? nullptr : &params[static_cast<std::size_t>(at)];
}

}  // namespace

Localization::Error Localization::error_of(std::uint64_t seed, BodyId body) const {
  if (error) return *error;
  Random random(seed, stream_id("odometry", "error"), body.value, 0);
  const double x = random.uniform(-k_way_error / 2, k_way_error / 2);
  const double y = random.uniform(-k_way_error / 2, k_way_error / 2);
  return {x, y, random.uniform(-k_turn_error / 2, k_turn_error / 2)};
}

void Odometry::advance(const Localization& how, const Localization::Error& error, double forward, double left,
                       double turn) {
  const double new_heading = wrap_angle(heading + turn * (1 + error.turn));
  const Vec2 way = Rotation(how.along_new_heading ? new_heading : heading) *
                   Vec2(forward * (1 + error.x), left * (1 + error.y));
  // + 0.0 turns -0 into 0: equal estimates have equal bits.
  *this = {x + way.x() + 0.0, y + way.y() + 0.0, new_heading + 0.0};
}

Pose relative_to(const Pose& origin, const Pose& pose) {
  const Vec2 p = Rotation(-origin.heading) * (pose.position() - origin.position());
  return {p.x() + 0.0, p.y() + 0.0, pose.z, wrap_angle(pose.heading - origin.heading) + 0.0};
}

Pose Estimates::of(Row row, std::size_t slot) const {
  if (!how) return {};
  const Pose& pose = poses[row.index()];
  if (how->kind == Localization::Kind::odom) {
    const Odometry& believed = odometries[slot];
    return {believed.x, believed.y, pose.z, believed.heading};
  }
  return how->origin ? relative_to(*how->origin, pose) : pose;
}

std::vector<Field> localization_fields() {
  return {
      {.name = "localization",
       .type = FieldType::text,
       .fallback = "gps",
       .text = "how it knows where it is: its true pose, or what its wheels counted",
       .choices = {"gps", "odom"}},
      {.name = "localization_origin",
       .type = FieldType::numbers,
       .unit = Unit::meters,
       .fallback = std::vector<double>{},
       .text = "[x, y] in the world of the frame it knows its pose in; [] is, with `gps`, the world's own, "
               "with `odom` that in which it starts at 0"},
      {.name = "localization_origin_heading",
       .unit = Unit::radians,
       .fallback = 0.0,
       .text = "of that frame, where `localization_origin` is given"},
      {.name = "odom_error",
       .type = FieldType::numbers,
       .fallback = std::vector<double>{},
       .text = "relative errors of `odom`, [forward, left, turn]; [] draws them for each robot, within "
               "[0.015, 0.015, 0.025] to either side"},
      {.name = "odom_heading",
       .type = FieldType::text,
       .fallback = "old",
       .text = "along which a tick's way is laid: the heading before its turn, as the robot moves, or after "
               "it, as in Stage",
       .choices = {"old", "new"}},
  };
}

Localization read_localization(const FieldTable& table, const Record& params) {
  Localization how;
  if (const Value* kind = find(table, params, "localization"); kind && kind->text() == "odom")
    how.kind = Localization::Kind::odom;
  if (const Value* at = find(table, params, "localization_origin"); at && at->numbers().size() == 2)
    how.origin = Pose{at->numbers()[0], at->numbers()[1], 0,
                      get(table, params, "localization_origin_heading").number()};
  if (const Value* error = find(table, params, "odom_error"); error && error->numbers().size() == 3)
    how.error = {error->numbers()[0], error->numbers()[1], error->numbers()[2]};
  if (const Value* heading = find(table, params, "odom_heading"))
    how.along_new_heading = heading->text() == "new";
  return how;
}

std::string localization_fault(const FieldTable& table, const Record& params) {
  if (const Value* at = find(table, params, "localization_origin");
      at && !at->numbers().empty() && at->numbers().size() != 2)
    return "localization_origin needs two numbers, [x, y], or none";
  if (const Value* error = find(table, params, "odom_error");
      error && !error->numbers().empty() && error->numbers().size() != 3)
    return "odom_error needs three numbers, [forward, left, turn], or none";
  return {};
}

}  // namespace troupe::engine
