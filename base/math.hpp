#pragma once

#include <cmath>
#include <numbers>
#include <span>

namespace troupe {

inline constexpr double k_pi = std::numbers::pi;  ///< the double nearest to pi

/// Elementary functions, computed from IEEE + - x / only. They give the same bits with every processor,
/// compiler and optimisation level; those of libm do not.
///
/// errors  below 1 ulp for every finite argument; below 0.9 ulp where tests/base/math_test.cpp compares with
///         long double. Large angles are reduced by pi itself, not by the nearest double
/// edges   NaN gives NaN; sin, cos of +-inf give NaN; exp overflows to inf and underflows to 0;
///         log(+-0) = -inf, log(x < 0) = NaN; atan2 of zeros and infinities follows IEEE 754 9.2
/// signs   sin and atan2 (in y) are odd bit for bit, zeros included, and cos is even
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
/// Sine and cosine with one argument reduction: the same bits as sin() and cos().
SinCos sincos(double radians);

/// Sines and cosines of many angles: the same bits in half the time, because the compiler vectorises the
/// loop. `out` must have the size of `radians`. (atan2 has no such form: with its three divisions it gained
/// nothing.)
void sincos(std::span<const double> radians, std::span<SinCos> out);

/// The angle wrapped into [-k_pi, k_pi]. Angles inside are returned unchanged, bit for bit; from others the
/// nearest multiple of 2 pi is subtracted, to within 1 ulp of the result. NaN and +-inf give NaN.
double wrap_angle(double radians);

/// Converts degrees to radians; rounds twice, the factor and the product.
constexpr double radians(double degrees) { return degrees * (k_pi / 180.0); }
/// Converts radians to degrees; rounds twice, the factor and the product.
constexpr double degrees(double radians) { return radians * (180.0 / k_pi); }

/// The square root. It is an IEEE basic operation, so that libm's rounds alike everywhere.
inline double sqrt(double x) { return std::sqrt(x); }

}  // namespace troupe
