#pragma once

#include "base/result.hpp"
#include "engine/fields/fields.hpp"

#include <cstddef>

namespace troupe::worldio {

/// Largest absolute value of a number in a `.world` file, the world file of Stage (an older robot simulator).
/// Above this value, doubles do not represent every whole number.
inline constexpr double k_largest_number = 9007199254740992.0;  // 2^53
/// Greatest number of levels of models and blocks inside one another, both in the text of a file and after
/// macros are expanded.
inline constexpr std::size_t k_deepest_nesting = 200;

/// Checks a number, in SI units, against the limits of a field (the description of a parameter). The error
/// text continues a sentence about the number, as in "must be above 0 m".
Result<> check_limits(const engine::Field& field, double value);

/// Returns a whole turn, 2 pi rad, if the angle, rad, exceeds it by less than 1e-5 of a turn, because files
/// write a whole turn as 6.2832. Returns every other angle unchanged.
double within_a_turn(double angle);

}  // namespace troupe::worldio
