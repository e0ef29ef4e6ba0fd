#pragma once

#include <cmath>
#include <numbers>
#include <span>

namespace troupe {

inline constexpr double k_pi = std::numbers::pi;  ///< the double nearest to pi

/// Sine, cosine and the rest, computed from IEEE + - x / only, so that every processor, compiler and
/// optimisation level gives the same bits; libm's do not.
///
/// errors  below 1 ulp for every finite argument, below 0.9 in what tests/base/math_test.cpp measures against
///         long double; large angles are reduced by pi itself, not by the nearest double
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

/// What sincos() gives.
struct SinCos {
  double sin;  ///< in -1 to 1
  double cos;  ///< in -1 to 1
};
/// Both at once: one argument reduction. The same bits as sin() and cos().
SinCos sincos(double radians);

/// Of many angles: the same bits in half the time, because the compiler takes several at once. (Of atan2,
/// with its three divisions, there is no such form: it gained nothing.) Sizes are equal.
void sincos(std::span<const double> radians, std::span<SinCos> out);

/// The angle wrapped into [-pi, pi] (the doubles). Angles already inside come back unchanged, bit for bit;
/// others lose the nearest multiple of 2 pi, to within 1 ulp of the result. NaN and +-inf give NaN.
double wrap_angle(double radians);

/// From degrees, as files and people write them; one rounding of the factor and one of the product.
constexpr double radians(double degrees) { return degrees * (k_pi / 180.0); }
/// To degrees.
constexpr double degrees(double radians) { return radians * (180.0 / k_pi); }

/// The square root is an IEEE basic operation and rounds the same everywhere.
inline double sqrt(double x) { return std::sqrt(x); }

}  // namespace troupe
