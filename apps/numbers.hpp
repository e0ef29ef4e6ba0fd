#pragma once

#include <cstdint>
#include <string>

/// Formatting of numbers in summaries; files contain all digits.
namespace troupe::apps {

/// With groups of three digits: `12,345,678`.
std::string grouped(std::uint64_t n);
/// Rounded to four digits: `0.01235`, `123.5`, `12,350`. Without an exponent from 0.0001 to 10^15.
std::string four_digits(double x);

}  // namespace troupe::apps
