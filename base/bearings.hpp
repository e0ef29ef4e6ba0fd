#pragma once

#include "base/pose.hpp"

#include <span>

namespace troupe {

/// Computes bearings[i], the angle from the x axis to the vector ways[i], rad, counter-clockwise; 0 for a
/// zero vector. The vectors must be finite. The angles are in [-pi, pi] and accurate to 3e-9 rad before they
/// are rounded to float. This is enough for readings of sensors, which are floats. The loop needs one
/// division and no branch per angle, so the compiler can vectorise it. The function atan2() (base/math.hpp),
/// whose error is below one unit in the last place of a double, takes several times as long. Both spans must
/// have the same size.
void to_bearings(std::span<const Vec2> ways, std::span<float> bearings);

}  // namespace troupe
