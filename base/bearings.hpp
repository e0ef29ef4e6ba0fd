#pragma once

#include "base/pose.hpp"

#include <span>

namespace troupe {

/// Computes the directions of many vectors: bearings[i] is the angle from the x axis to ways[i], rad,
/// counter-clockwise; 0 for a zero vector. Both spans must have the same size. The magnitudes of coordinates
/// must be below 1e300. Before they are rounded to float, the angles are in [-pi, pi], and their error is at
/// most 3e-9 rad. The function takes a fraction of the time of atan2() (base/math.hpp), because the compiler
/// can vectorise it.
void to_bearings(std::span<const Vec2> ways, std::span<float> bearings);

}  // namespace troupe
