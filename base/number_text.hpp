#pragma once

#include <string>

namespace troupe {

/// A number for messages, rounded to `digits` significant digits (larger numbers to a whole number), without
/// an exponent: `0.000001`, `1000000000`. Numbers below 1e-9 and from 1e16 on are written with an exponent,
/// because they would be hard to read without one.
std::string plain_number(double x, int digits = 10);

}  // namespace troupe
