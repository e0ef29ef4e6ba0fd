#pragma once

#include "render/canvas.hpp"

#include <span>
#include <utility>
#include <vector>

namespace troupe::render {

/// The colour of a value from 0 to 1, from dark violet to yellow with increasing lightness, so that it is
/// readable in grey and for the colour-blind. Values outside 0 to 1 are clamped.
Rgba value_color(double share);
/// The colour of bodies without a value.
inline constexpr Rgba k_no_value = {170, 166, 158, 255};

/// The smallest and the largest of the values that are numbers. If they are equal, an interval around them.
std::pair<double, double> range_of(std::span<const double> values);
/// One colour per value.
std::vector<Rgba> value_colors(std::span<const double> values, const std::pair<double, double>& range);

}  // namespace troupe::render
