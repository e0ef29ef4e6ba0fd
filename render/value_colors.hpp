#pragma once

#include "render/canvas.hpp"

#include <span>
#include <utility>
#include <vector>

namespace troupe::render {

/// A value from 0 to 1 as a colour, from dark violet to yellow, growing in lightness all the way: it can be
/// read in grey, and by the colour-blind. Beyond 0 to 1 the nearest of these.
Rgba value_color(double share);
/// What has no value.
inline constexpr Rgba k_no_value = {170, 166, 158, 255};

/// The smallest and the largest of the values that are numbers; of equal ones something around them.
std::pair<double, double> range_of(std::span<const double> values);
/// A colour a value.
std::vector<Rgba> value_colors(std::span<const double> values, const std::pair<double, double>& range);

}  // namespace troupe::render
