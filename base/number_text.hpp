#pragma once

#include <string>

namespace troupe {

/// A number as text for messages, normally without an exponent: `0.000001`, `1000000000`. Numbers with more
/// than `digits` digits before the point are rounded to a whole number, all others to `digits` significant
/// digits. Numbers whose absolute value is below 1e-9 (except 0) or at least 1e16 would be hard to read in
/// this form. They are written with an exponent and `digits` significant digits. Infinities and NaN give
/// `inf`, `-inf` and `nan`. `digits` must be from 1 to 16.
std::string plain_number(double x, int digits = 10);

}  // namespace troupe
