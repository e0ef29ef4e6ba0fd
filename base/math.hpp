#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace troupe {

inline constexpr double k_pi = std::numbers::pi;                           ///< the double nearest to pi
inline constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();  ///< not a number

/// Elementary functions that give the same bits with every processor, compiler and optimisation level, unlike
/// the functions of libm. They use only additions, subtractions, multiplications and divisions, whose results
/// IEEE 754 defines to the last bit. Angles are in radians.
///
/// errors  below 1 ulp for every finite argument; below 0.9 ulp where tests/base/math_test.cpp compares with
///         long double. Large angles are reduced with as many digits of pi as they need, not with the double
///         nearest to pi
/// edges   NaN gives NaN; sin and cos of +-inf give NaN; exp overflows to inf and underflows to 0; log(+-0) =
///         -inf, log(x < 0) = NaN; atan2 of zeros and infinities follows IEEE 754 9.2
/// signs   sin and atan2 (in y) are odd functions bit for bit, zeros included, and cos is even
///@{
double sin(double radians);
double cos(double radians);
double atan2(double y, double x);
double exp(double x);
double log(double x);
///@}

/// The result of sincos().
struct SinCos {
  double sin;  ///< the sine, in [-1, 1]
  double cos;  ///< the cosine, in [-1, 1]
};
/// Computes sine and cosine together, faster than sin() and cos() and with the same bits. NaN and +-inf give
/// NaN.
SinCos sincos(double radians);

/// Computes the sines and cosines of many angles, rad. Each result has the bits of sincos(double). The
/// function takes half the time of single calls, because the compiler vectorises its loop. `out` must have
/// the size of `radians`.
void sincos(std::span<const double> radians, std::span<SinCos> out);

/// Sums the rows of a row-major array. The terms of a row are added from first to last, starting from 0, so
/// an empty row gives 0.
///
/// values   all rows, one after another: sums.size() x columns numbers
/// columns  number of terms of each row, at least 0
/// sums     receives the sum of each row
void sum_rows(std::span<const double> values, std::size_t columns, std::span<double> sums);

/// Wraps an angle into [-k_pi, k_pi]. An angle in this interval is returned unchanged, bit for bit. For any
/// other angle, the nearest multiple of 2 pi is subtracted, with an error of at most 1 ulp of the result. NaN
/// and +-inf give NaN.
double wrap_angle(double radians);

/// Converts degrees to radians. Both the factor k_pi / 180 and the product are rounded.
constexpr double radians(double degrees) { return degrees * (k_pi / 180.0); }
/// Converts radians to degrees. Both the factor 180 / k_pi and the product are rounded.
constexpr double degrees(double radians) { return radians * (180.0 / k_pi); }

/// Returns the square root, from libm. IEEE 754 requires it to be correctly rounded, so libm gives the same
/// bits everywhere.
inline double sqrt(double x) { return std::sqrt(x); }

}  // namespace troupe
