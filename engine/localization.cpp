#include "engine/localization.hpp"

#include "base/random.hpp"

namespace troupe::engine {
namespace {

// How far odometry is off where the world does not say: Stage's, of which half to either side.
constexpr double k_way_error = 0.03;
constexpr double k_turn_error = 0.05;

/// localization_fields(), in their order.
enum Param : std::size_t { k_kind, k_origin, k_origin_heading, k_error, k_heading };

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

Localization read_localization(std::span<const Value> params) {
  Localization how;
  if (params[k_kind].text() == "odom") how.kind = Localization::Kind::odom;
  const std::vector<double>& at = params[k_origin].numbers();
  if (at.size() == 2) how.origin = Pose{at[0], at[1], 0, params[k_origin_heading].number()};
  const std::vector<double>& error = params[k_error].numbers();
  if (error.size() == 3) how.error = {error[0], error[1], error[2]};
  how.along_new_heading = params[k_heading].text() == "new";
  return how;
}

Result<> check_localization(std::span<const Value> params) {
  const std::size_t at = params[k_origin].numbers().size();
  if (at != 0 && at != 2) return Error{"localization_origin needs two numbers, [x, y], or none"};
  const std::size_t errors = params[k_error].numbers().size();
  if (errors != 0 && errors != 3)
    return Error{"odom_error needs three numbers, [forward, left, turn], or none"};
  return {};
}

}  // namespace troupe::engine
