#pragma once

#include <string>

namespace troupe {

/// Returns a number as text for messages, without an exponent where this is readable. Let `digits` be 10:
///
/// - 0, and numbers with an absolute value of at least 1e-9 and below 1e16, have no exponent: `0.000001`,
///   `1000000000`. They are rounded to 10 significant digits. But a number with more than 10 digits before
///   the point is only rounded to a whole number: `123456789012`.
/// - Other numbers have an exponent and are rounded to 10 significant digits: `1.5e-10`.
/// - Infinities and NaN give `inf`, `-inf` and `nan`.
///
/// digits: number of significant digits, from 1 to 16
std::string plain_number(double x, int digits = 10);

}  // namespace troupe
