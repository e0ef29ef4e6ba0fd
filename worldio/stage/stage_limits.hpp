#pragma once

#include "base/result.hpp"
#include "engine/fields/fields.hpp"

#include <cstddef>

namespace troupe::worldio {

/// Largest absolute value that a number in a `.world` file may have. Such files are the world files of Stage,
/// an older robot simulator. Above this value, doubles do not represent every whole number.
inline constexpr double k_largest_number = 9007199254740992.0;  // 2^53
/// Greatest depth to which models and blocks may be nested, both in the text of a file and after macros are
/// expanded.
inline constexpr std::size_t k_deepest_nesting = 200;

/// Checks that a number, in SI units, is within the limits of a parameter. `field` describes the parameter.
/// The text of the error is the end of a sentence about the number, such as "must be above 0 m".
Result<> check_limits(const engine::Field& field, double value);

/// Returns 2 pi for an angle, rad, that exceeds 2 pi by less than 1e-5 of a turn. Returns every other angle
/// unchanged. Files write a whole turn as 6.2832, which is slightly more than 2 pi.
double within_a_turn(double angle);

}  // namespace troupe::worldio
