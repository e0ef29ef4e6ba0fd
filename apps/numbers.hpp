#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Functions that format numbers for the summaries that users read. They are not used for output files, which
/// contain all digits of numbers.
namespace troupe::apps {

/// Returns an integer as text, in groups of three digits: `12,345,678`.
std::string grouped(std::uint64_t n);
/// Returns a number as text, rounded to four significant digits: `0.01235`, `123.5`, `12,350`. A number other
/// than 0 is written with an exponent if its absolute value is below 0.0001, or is 10^15 or more.
std::string four_digits(double x);

/// Returns a count and a noun as text: "1 robot", "2 robots". what: the noun in the singular; `s` is appended
/// if the count is not 1.
std::string counted(std::uint64_t count, std::string_view what);

}  // namespace troupe::apps
