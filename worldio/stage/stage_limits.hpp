#pragma once

#include "base/result.hpp"
#include "engine/fields.hpp"

#include <cstddef>

namespace troupe::worldio {

/// Largest absolute value of a number in a file: above it, doubles do not represent every whole number.
inline constexpr double k_largest_number = 9007199254740992.0;  // 2^53
/// Largest depth of models and blocks inside one another, as the file writes them and after macros are
/// expanded.
inline constexpr std::size_t k_deepest_nesting = 200;

/// Checks a number, in SI units, against the limits of a field. The error text continues a sentence about the
/// number, as in "must be above 0 m".
Result<> check_limits(const engine::Field& field, double value);

/// Returns an angle, rad. If it is slightly above a whole turn, returns a whole turn, because files write a
/// whole turn as 6.2832.
double within_a_turn(double angle);

}  // namespace troupe::worldio
