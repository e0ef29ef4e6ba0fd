#include "worldio/stage/stage_limits.hpp"

#include "base/math.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace troupe::worldio {

Result<> check_limits(const engine::Field& field, double value) {
  const std::string_view symbol = engine::unit_suffixes(field.unit)[0].symbol;
  const std::string unit = symbol.empty() ? "" : fmt::format(" {}", symbol);
  if (field.above_min && !(value > field.min))
    return Error{fmt::format("must be above {}{}", field.min, unit)};
  if (!(value >= field.min)) return Error{fmt::format("must be at least {}{}", field.min, unit)};
  if (!(value <= field.max)) return Error{fmt::format("must be at most {}{}", field.max, unit)};
  return {};
}

double within_a_turn(double angle) {
  constexpr double k_turn = 2 * k_pi;
  constexpr double k_rounding = 1e-5;
  return angle > k_turn && angle < k_turn * (1 + k_rounding) ? k_turn : angle;
}

}  // namespace troupe::worldio
