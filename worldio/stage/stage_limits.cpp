#include "worldio/stage/stage_limits.hpp"

#include "base/math.hpp"
#include "base/number_text.hpp"
#include "engine/fields/description.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

namespace troupe::worldio {

std::string in_unit(double value, const engine::Field& field, double to_si) {
  constexpr int k_digits = 6;
  std::string_view symbol;  // none for units such as millimetres, which the file itself defines
  if (to_si == 1)
    symbol = engine::unit_suffixes(field.unit)[0].symbol;
  else if (field.unit == engine::Unit::radians && std::abs(to_si - radians(1)) < 1e-9)
    symbol = "deg";
  return plain_number(value / to_si, k_digits) + (symbol.empty() ? "" : " ") + std::string(symbol);
}

Result<> check_limits(const engine::Field& field, double value, double to_si) {
  if (field.above_min && !(value > field.min))
    return Error{fmt::format("must be above {}", in_unit(field.min, field, to_si))};
  if (!(value >= field.min))
    return Error{fmt::format("must be at least {}", in_unit(field.min, field, to_si))};
  if (!(value <= field.max))
    return Error{fmt::format("must be at most {}", in_unit(field.max, field, to_si))};
  if (engine::has_whole_numbers(field) && std::trunc(value) != value) return Error{"must be a whole number"};
  return {};
}

double within_a_turn(double angle) {
  constexpr double k_turn = 2 * k_pi;
  constexpr double k_rounding = 1e-5;
  const double size = std::abs(angle);
  return size > k_turn && size < k_turn * (1 + k_rounding) ? std::copysign(k_turn, angle) : angle;
}

}  // namespace troupe::worldio
