#include "base/bearings.hpp"

#include "base/math.hpp"

#include <algorithm>
#include <cmath>

namespace troupe {

void to_bearings(std::span<const Vec2> ways, std::span<float> bearings) {
  constexpr double k_tan_22_5_deg = 0.41421356237309503;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double x = ways[i].x();
    const double y = ways[i].y();
    const double far = std::max(std::abs(x), std::abs(y));
    const double near = std::min(std::abs(x), std::abs(y));
    // Reduces the angle (up to 45 degrees) by 45 degrees if it is above 22.5, so that |u| is at most 0.42.
    const bool is_wide = near > k_tan_22_5_deg * far;
    const double up = is_wide ? near - far : near;
    const double along = is_wide ? near + far : far;
    const double u = up / (along > 0 ? along : 1.0);
    const double u2 = u * u;
    double series = 1 / 17.0;
    series = 1 / 15.0 - series * u2;
    series = 1 / 13.0 - series * u2;
    series = 1 / 11.0 - series * u2;
    series = 1 / 9.0 - series * u2;
    series = 1 / 7.0 - series * u2;
    series = 1 / 5.0 - series * u2;
    series = 1 / 3.0 - series * u2;
    double angle = u - series * u2 * u + (is_wide ? k_pi / 4 : 0.0);
    angle = std::abs(y) > std::abs(x) ? k_pi / 2 - angle : angle;
    angle = x < 0 ? k_pi - angle : angle;
    bearings[i] = static_cast<float>(y < 0 ? -angle : angle) + 0.0f;  // turns -0 into 0
  }
}

}  // namespace troupe
