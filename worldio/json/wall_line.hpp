#pragma once

#include "base/geometry.hpp"
#include "base/result.hpp"

#include <vector>

namespace troupe::worldio {

/// Whether a line of walls is closed: it has three or more points and ends at its first point. The walls of a
/// closed line also have a corner at this point.
bool is_closed(const Ring& line);

/// Checks that walls can be built along a line. `line` has the points, m, of the line along the middle of the
/// walls, at least two, and `thickness` is the thickness of the walls, m. Returns an error in these cases:
/// - A point is equal to the point before it.
/// - The line turns by more than 165 degrees at a point.
/// - A segment is too short for the thickness: the mitred corners at its two ends overlap.
Result<> check_wall_line(const Ring& line, double thickness);

/// Returns the walls along a line, in the frame of its points: one prism per segment, from z = 0 to `height`,
/// m. Walls of neighbouring segments meet in a mitred corner. check_wall_line() must accept `line` and
/// `thickness`.
std::vector<Solid> wall_solids(const Ring& line, double thickness, double height);

}  // namespace troupe::worldio
