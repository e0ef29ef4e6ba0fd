#include "engine/kinds/localization.hpp"

#include "base/random.hpp"

#include <string>

namespace troupe::engine {
namespace {

// Default ranges of the relative odometry errors, as in Stage. An error is uniformly distributed around 0,
// and at most half of the range in size.
constexpr double k_way_error = 0.03;
constexpr double k_turn_error = 0.05;

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
    const Odometry& estimate = odometries[slot];
    return {estimate.x, estimate.y, pose.z, estimate.heading};
  }
  return how->origin ? relative_to(*how->origin, pose) : pose;
}

Result<Localization> LocalizationParams::read() const {
  const std::vector<double>& at = localization_origin;
  if (!at.empty() && at.size() != 2)
    return Error{"localization_origin must have two numbers, [x, y], or none, found " +
                 std::to_string(at.size())};
  const std::vector<double>& error = odom_error;
  if (!error.empty() && error.size() != 3)
    return Error{"odom_error must have three numbers, [forward, left, turn], or none, found " +
                 std::to_string(error.size())};
  Localization how{.kind = localization, .along_new_heading = odom_heading == Heading::changed};
  if (!at.empty()) how.origin = Pose{at[0], at[1], 0, localization_origin_heading};
  if (!error.empty()) how.error = {error[0], error[1], error[2]};
  return how;
}

}  // namespace troupe::engine
