#include "base/number_text.hpp"

#include "base/geometry.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace troupe {
namespace {

/// Whether a number is readable without an exponent.
bool is_readable(double x) {
  const double size = std::abs(x);
  return x == 0 || (size >= 1e-9 && size < 1e16);
}

}  // namespace

std::string plain_number(double x, int digits) {
  std::string text = fmt::format("{:.{}g}", x, digits);
  const std::size_t e = text.find('e');
  if (e == text.npos || !is_readable(x)) return text;
  if (std::abs(x) >= 1) return fmt::format("{:.0f}", x);
  const int decimals = digits - 1 - std::stoi(text.substr(e + 1));  // the exponent is negative
  text = fmt::format("{:.{}f}", x, decimals);
  text.erase(text.find_last_not_of('0') + 1);
  return text;
}

std::string exact_number(double x) {
  if (!is_readable(x)) return fmt::format("{}", x);
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::fixed).ptr;
  return {text.data(), end};
}

std::string extent_text(const Box& box) {
  return fmt::format("x {} to {}, y {} to {} m", plain_number(box.min.x()), plain_number(box.max.x()),
                     plain_number(box.min.y()), plain_number(box.max.y()));
}

std::optional<double> finite_number_of(std::string_view text) {
  const std::optional<double> value = number_of<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace troupe
