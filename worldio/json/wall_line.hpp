#pragma once

#include "base/geometry.hpp"
#include "base/result.hpp"

#include <vector>

namespace troupe::worldio {

/// Checks that walls of this thickness, m, can be built along a line of points, m. The line is the middle of
/// the walls. Returns an error if the line has fewer than two points, if a point repeats the one before it,
/// if the line turns by more than 165 degrees at a point, or if a segment is too short for the corners at its
/// ends. A line of three or more points whose last point repeats its first is closed, and also turns at that
/// point.
Result<> check_wall_line(const Ring& line, double thickness);

/// Returns walls along a line, in the frame of the line: one prism of four corners per segment, with mitred
/// corners between two segments, from z = 0 to `height`, m. The line must pass check_wall_line().
std::vector<Solid> wall_solids(const Ring& line, double thickness, double height);

}  // namespace troupe::worldio
