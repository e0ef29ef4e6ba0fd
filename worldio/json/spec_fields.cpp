#include "worldio/json/spec_fields.hpp"

#include "base/diagnostics.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;

template <class Kinds>
Result<const FieldTable*> find_kind(std::string_view what, const std::string& name, const Kinds& kinds) {
  const auto found = std::ranges::find(kinds, std::string_view(name), &Kinds::value_type::name);
  if (found == kinds.end()) return Error{unknown_name(what, name, name_list(kinds))};
  return &found->params;
}

}  // namespace

std::string SpecPath::text() const {
  const std::string before = parent != nullptr ? parent->text() : std::string();
  if (name.empty()) return fmt::format("{}[{}]", before, index);
  return before.empty() ? std::string(name) : fmt::format("{}.{}", before, name);
}

bool is_listed(const FieldTable& table) {
  return std::ranges::all_of(table.fields, [](const Field& field) {
    if (field.type == FieldType::record) return field.record != nullptr && is_listed(*field.record);
    return field.type == FieldType::integer || field.type == FieldType::number ||
           (field.type == FieldType::numbers && field.columns > 0);
  });
}

std::size_t numbers_in(const FieldTable& table) {
  std::size_t sum = 0;
  for (const Field& field : table.fields)
    sum +=
        field.type == FieldType::record ? numbers_in(*field.record) : std::max<std::size_t>(field.columns, 1);
  return sum;
}

Result<const FieldTable*> parameters_of(const FieldTable& table, const void* object,
                                        const engine::Registry& registry) {
  if (&table == &engine::world_fields()) return &window_fields();
  const engine::Value value = engine::get(table.at("kind"), object);
  const std::string& kind = value.text();
  if (&table == &engine::drive_fields()) return find_kind("drive", kind, registry.drives);
  if (&table == &engine::measure_fields()) {
    const auto found = registry.find_measure(kind);
    if (!found) return found.error();
    return &(*found)->params;
  }
  if (&table == &engine::impairment_fields()) return find_kind("fault", kind, registry.faults);
  if (&table == &engine::controller_fields()) {
    const auto found = registry.find_controller(kind);
    if (!found) return found.error();
    return &(*found)->params;
  }
  const auto found = registry.find_device(kind, unknown_name("device", kind, name_list(registry.devices)));
  if (!found) return found.error();
  return &(*found)->params;
}

}  // namespace troupe::worldio
