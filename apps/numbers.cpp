#include "apps/numbers.hpp"

#include "base/number_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace troupe::apps {

std::string grouped(std::uint64_t n) {
  std::string text = fmt::format("{}", n);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<std::size_t>(at), 1, ',');
  return text;
}

std::string four_digits(double x) {
  constexpr double k_first_exponent = 9999.5;  // from this value on {:.4g} writes an exponent
  // Doubles represent all integers up to this value. Longer numbers are hard to read.
  constexpr double k_largest = 1e15;
  const double size = std::abs(x);
  if (!(size >= k_first_exponent && size < k_largest)) return fmt::format("{:.4g}", x);
  const double rounded = number_of<double>(fmt::format("{:.3e}", size)).value_or(size);
  return (x < 0 ? "-" : "") + grouped(static_cast<std::uint64_t>(rounded));
}

std::string counted(std::uint64_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace troupe::apps
