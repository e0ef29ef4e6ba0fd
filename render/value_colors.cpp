#include "render/value_colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace troupe::render {
namespace {

/// Nine equally spaced colours of the colour map viridis (van der Walt and Smith, public domain), from 0 to
/// 1.
constexpr std::array<std::array<double, 3>, 9> k_steps = {{{68, 1, 84},
                                                           {71, 44, 122},
                                                           {59, 81, 139},
                                                           {44, 113, 142},
                                                           {33, 144, 141},
                                                           {39, 173, 129},
                                                           {92, 200, 99},
                                                           {170, 220, 50},
                                                           {253, 231, 37}}};

}  // namespace

Rgba value_color(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(k_steps.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), k_steps.size() - 2);
  const double rest = place - static_cast<double>(below);
  Rgba color{0, 0, 0, 255};
  for (std::size_t k = 0; k < 3; ++k)
    color[k] = static_cast<std::uint8_t>(
        std::lround(k_steps[below][k] + rest * (k_steps[below + 1][k] - k_steps[below][k])));
  return color;
}

std::pair<double, double> range_of(std::span<const double> values) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (low > high) return {0, 1};
  if (low == high) return {low - 0.5, high + 0.5};
  return {low, high};
}

std::vector<Rgba> value_colors(std::span<const double> values, const std::pair<double, double>& range) {
  std::vector<Rgba> colors;
  colors.reserve(values.size());
  // The halves are used, because the difference of two finite numbers may be infinite.
  const double low = range.first / 2;
  const double across = range.second / 2 - low;
  for (const double value : values)
    colors.push_back(std::isnan(value) ? k_no_value
                                       : value_color(across > 0 ? (value / 2 - low) / across : 0.5));
  return colors;
}

}  // namespace troupe::render
