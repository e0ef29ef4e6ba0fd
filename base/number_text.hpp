#pragma once

#include <string>

namespace troupe {

/// A number as text for messages, normally without an exponent: `0.000001`, `1000000000`. Numbers with more
/// than `digits` digits before the point are rounded to a whole number, all others to `digits` significant
/// digits. Only numbers that would be hard to read in this form have an exponent, and `digits` significant
/// digits: those whose absolute value is below 1e-9 (except 0) or at least 1e16. Infinities and NaN give
/// `inf`, `-inf` and `nan`. `digits` must be from 1 to 16.
std::string plain_number(double x, int digits = 10);

}  // namespace troupe
