#include "troupe/value_names.hpp"

#include "base/number_text.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace troupe {
namespace {

/// Splits a name at its last dot. Returns nothing if there is no dot.
std::optional<std::pair<std::string, std::string>> split_last(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == name.npos) return std::nullopt;
  return std::pair(name.substr(0, dot), name.substr(dot + 1));
}

}  // namespace

std::vector<ChosenValue> readings_of(const std::string& name) {
  std::vector<ChosenValue> readings;
  const auto whole = split_last(name);
  if (!whole) return readings;
  readings.push_back({whole->first, whole->second, 0, {}});
  const std::optional<std::size_t> column = number_of<std::size_t>(whole->second);
  if (!column) return readings;
  if (const auto field = split_last(whole->first))
    readings.push_back({field->first, field->second, *column, {}});
  return readings;
}

std::string with_unit(const std::string& name, std::string_view unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

Error no_such_column(const ChosenValue& value, std::size_t columns) {
  if (columns == 0) return {fmt::format("\"{}.{}\" has no columns", value.component, value.field)};
  return {fmt::format("there is no column {}: \"{}.{}\" has only the columns 0 to {}", value.column,
                      value.component, value.field, columns - 1)};
}

}  // namespace troupe
