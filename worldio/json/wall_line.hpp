#pragma once

#include "base/geometry.hpp"
#include "base/result.hpp"

#include <vector>

namespace troupe::worldio {

/// Checks that walls of this thickness, m, can be built along a line, which is the middle of the walls.
/// Returns an error if the line has fewer than two points, if a point repeats the one before it, if the line
/// turns back at a point by more than 165 degrees, or if a segment is too short for the corners at its ends.
Result<> check_wall_line(const Ring& line, double thickness);

/// Returns walls along a line, m: one prism of four corners per segment, with mitred corners between two
/// segments, from the floor to `height`. A line whose last point repeats its first is closed. The line must
/// pass check_wall_line().
std::vector<Solid> wall_solids(const Ring& line, double thickness, double height);

}  // namespace troupe::worldio
