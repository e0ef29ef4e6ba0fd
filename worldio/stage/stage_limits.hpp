#pragma once

#include "base/result.hpp"
#include "engine/fields/fields.hpp"

#include <cstddef>
#include <string>

namespace troupe::worldio {

/// Largest absolute value that a number in a `.world` file may have. Such files are the world files of Stage,
/// an older robot simulator. Above this value, doubles do not represent every whole number.
inline constexpr double k_largest_number = 9007199254740992.0;  // 2^53
/// Greatest depth to which models and blocks may be nested, both in the text of a file and after macros are
/// expanded.
inline constexpr std::size_t k_deepest_nesting = 200;

/// Returns a number as text in the unit in which a file gives it, with the name of the unit if it is the SI
/// unit or degrees: "0.5 m", "90 deg".
/// value  the number in SI units
/// field  the description of the parameter
/// to_si  the unit of the file, in SI units
std::string in_unit(double value, const engine::Field& field, double to_si = 1);

/// Checks that a number is within the limits of a parameter. The arguments are those of in_unit(). The text
/// of the error is the end of a sentence about the number, such as "must be above 0 m".
Result<> check_limits(const engine::Field& field, double value, double to_si = 1);

/// Returns a whole turn, 2 pi or -2 pi, for an angle, rad, that exceeds it by less than 1e-5 of a turn.
/// Returns every other angle unchanged. Files write a whole turn as 6.2832, which is slightly more than 2 pi.
double within_a_turn(double angle);

}  // namespace troupe::worldio
