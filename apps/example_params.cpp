#include "apps/example_params.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace troupe::apps {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;

/// Smallest number of beams, pixels, bytes and so on of a device, with Example::wide.
constexpr double k_readings = 16;

}  // namespace

Record example_params(const FieldTable& table, Example example) {
  const bool is_wide = example == Example::wide;
  Record record = table.defaults();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    engine::Value& value = record[i];
    if (field.optional) continue;
    if (field.record != nullptr) {
      value = std::vector<Record>{example_params(*field.record, example)};
    } else if (field.type == FieldType::integer) {
      const double least = is_wide ? k_readings : 1;
      const auto one = static_cast<std::int64_t>(std::clamp(least, field.min, field.max));
      if (!value.given() || is_wide) value = value.given() ? std::max(value.integer(), one) : one;
    } else if (field.type == FieldType::number) {
      const bool is_view = field.unit == engine::Unit::radians && field.min >= 0 && std::isfinite(field.max);
      if (is_wide && is_view) value = field.max;
      if (!value.given()) value = std::clamp(1.0, field.min, field.max);
    } else if (field.type == FieldType::numbers && !value.given()) {
      value =
          std::vector<double>(std::max<std::size_t>(field.columns, 1), std::clamp(1.0, field.min, field.max));
    } else if (field.type == FieldType::text && !value.given()) {
      value = std::string(field.choices.empty() ? "name" : field.choices.front());
    } else if (field.type == FieldType::text && example == Example::named && value.text().empty()) {
      value = std::string("name");
    }
  }
  return record;
}

std::optional<engine::DeviceKind::Prepared> prepare_example(const engine::DeviceKind& kind, Example example) {
  try {
    return kind.prepare(example_params(kind.params, example), {});
  } catch (...) {
    return std::nullopt;  // a plug-in may throw anything
  }
}

}  // namespace troupe::apps
