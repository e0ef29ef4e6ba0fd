#pragma once

#include <cstdint>
#include <string>

/// Formatting of numbers in summaries for users. Files contain all digits instead.
namespace troupe::apps {

/// Returns an integer as text, in groups of three digits: `12,345,678`.
std::string grouped(std::uint64_t n);
/// Returns a number as text, rounded to four digits: `0.01235`, `123.5`, `12,350`. Absolute values from
/// 0.0001 to 10^15 have no exponent.
std::string four_digits(double x);

}  // namespace troupe::apps
