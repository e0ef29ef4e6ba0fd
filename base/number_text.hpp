#pragma once

#include <string>

namespace troupe {

/// A number as text for messages, without an exponent: `0.000001`, `1000000000`. Numbers with more than
/// `digits` digits before the point are rounded to a whole number, all others to `digits` significant digits.
/// Numbers whose absolute value is below 1e-9 (except 0) or at least 1e16 have `digits` significant digits
/// and an exponent, because such numbers would be hard to read without an exponent. Infinities and NaN give
/// `inf`, `-inf` and `nan`. `digits` must be from 1 to 16.
std::string plain_number(double x, int digits = 10);

}  // namespace troupe
