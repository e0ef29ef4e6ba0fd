#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace troupe {

struct Box;  // base/geometry.hpp

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
/// Returns a number as the shortest text that converts back to the same number, for errors about numbers from
/// input files. A rounded number could seem to be within the limits that it exceeds. The text has an exponent
/// in the same cases as that of plain_number(): `3600.0000001`, `1e+30`.
std::string exact_number(double x);
/// Returns the extent of a box as text for messages: `x -2 to 2, y 0 to 5.5 m`. The numbers are written by
/// plain_number().
std::string extent_text(const Box& box);

/// Converts a whole text to a number of type T. Returns std::nullopt if the text is not a decimal number,
/// contains anything else (a space, a unit, a leading `+`), or is outside the range of T. For a
/// floating-point T, `inf` and `nan` are accepted.
template <class T>
std::optional<T> number_of(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}
/// Like number_of<double>(), but also returns std::nullopt for inf and nan.
std::optional<double> finite_number_of(std::string_view text);

}  // namespace troupe
