#pragma once

#include "base/result.hpp"
#include "engine/fields.hpp"

namespace troupe::worldio {

/// Checks a number, in SI units, against the limits of a field. The error text continues a sentence about the
/// number, as in "must be above 0 m".
Result<> check_limits(const engine::Field& field, double value);

/// Returns an angle, rad. If it is slightly above a whole turn, returns a whole turn, because files write a
/// whole turn as 6.2832.
double within_a_turn(double angle);

}  // namespace troupe::worldio
