#pragma once

#include "render/canvas.hpp"

#include <span>
#include <utility>
#include <vector>

namespace troupe::render {

/// Returns the colour for a number from 0 (dark violet) to 1 (yellow). Lightness increases with the number,
/// so that the scale is readable in grey and for the colour-blind. Numbers outside 0 to 1 are clamped; the
/// number must not be NaN.
Rgba value_color(double share);
/// The colour of bodies whose value is NaN, which means that they have no value.
inline constexpr Rgba k_no_value = {170, 166, 158, 255};

/// Returns the smallest and the largest finite value. If both are x, returns x - 0.5 and x + 0.5. If no value
/// is finite, returns 0 and 1.
std::pair<double, double> range_of(std::span<const double> values);
/// Returns one colour per value. The scale of value_color() extends from range.first to range.second, which
/// must be finite. Values outside the range have the colour of the nearer end of the scale. If range.first is
/// not below range.second, all values have the middle colour. NaN always has the colour k_no_value.
std::vector<Rgba> value_colors(std::span<const double> values, const std::pair<double, double>& range);

}  // namespace troupe::render
