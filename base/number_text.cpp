#include "base/number_text.hpp"

#include "base/geometry.hpp"

#include <fmt/format.h>

#include <cmath>

namespace troupe {

std::string plain_number(double x, int digits) {
  std::string text = fmt::format("{:.{}g}", x, digits);
  const std::size_t e = text.find('e');
  if (e == text.npos) return text;
  const double size = std::abs(x);
  if (size < 1e-9 || size >= 1e16) return text;
  if (size >= 1) return fmt::format("{:.0f}", x);
  const int decimals = digits - 1 - std::stoi(text.substr(e + 1));  // the exponent is negative
  text = fmt::format("{:.{}f}", x, decimals);
  text.erase(text.find_last_not_of('0') + 1);
  return text;
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
