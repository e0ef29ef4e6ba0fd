#include "engine/observing/state_difference.hpp"

#include "base/sort.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace troupe::engine {
namespace {

std::string decimal(const StateValue& value) {
  switch (value.element) {
    case Element::f64: return fmt::format("{}", std::bit_cast<double>(value.bits));
    case Element::f32: return fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(value.bits)));
    case Element::i64: return fmt::format("{}", static_cast<std::int64_t>(value.bits));
    case Element::i32:
      return fmt::format("{}", static_cast<std::int32_t>(static_cast<std::uint32_t>(value.bits)));
    case Element::u64:
    case Element::u32:
    case Element::u8: break;
  }
  return fmt::format("{}", value.bits);
}

std::uint64_t bits_at(const std::byte* place, std::size_t size) {
  switch (size) {
    case 8: {
      std::uint64_t bits = 0;
      std::memcpy(&bits, place, sizeof bits);
      return bits;
    }
    case 4: {
      std::uint32_t bits = 0;
      std::memcpy(&bits, place, sizeof bits);
      return bits;
    }
    default: return std::to_integer<std::uint64_t>(*place);
  }
}

/// Calls `report` for each column of a field in which two rows differ. `first` and `second` point at the
/// field in the first and in the second row.
void compare_fields(const StateField& field, const std::byte* first, const std::byte* second,
                    const ReportValue& report) {
  const std::size_t size = element_size(field.element);
  if (std::memcmp(first, second, size * field.columns) == 0) return;
  for (std::size_t column = 0; column < field.columns; ++column) {
    const StateValue a{field.element, bits_at(first + column * size, size)};
    const StateValue b{field.element, bits_at(second + column * size, size)};
    if (a.bits != b.bits) report(field, column, a, b);
  }
}

/// Indices of the rows of a table, sorted by the ids of their bodies, so that two tables can be compared body
/// by body.
std::vector<std::size_t> rows_by_id(const StateTable& table) {
  std::vector<std::uint64_t> ids;
  for (std::size_t r = 0; r < table.rows(); ++r) ids.push_back(table.ids()[r].value);
  return sorted_order(ids);
}

/// Difference between two tables of one component: the number of bodies whose rows differ (`bodies`), and the
/// first value that differs. If the tables have different bodies or fields, `bodies` is 0.
ComponentDifference table_difference(const StateTable& a, const StateTable& b) {
  ComponentDifference found{.component = a.component(), .group = a.group()};
  if (a.component() != b.component() || a.rows() != b.rows() || !same_fields(a.fields(), b.fields()))
    return found;
  const std::vector<std::size_t> rows_a = rows_by_id(a);
  const std::vector<std::size_t> rows_b = rows_by_id(b);
  for (std::size_t i = 0; i < rows_a.size(); ++i) {
    const BodyId id = a.ids()[rows_a[i]];
    if (id != b.ids()[rows_b[i]]) return {.component = a.component(), .group = a.group()};
    bool differs = false;
    for (std::size_t f = 0; f < a.fields().size(); ++f) {
      compare_fields(
          a.fields()[f], a.cell<std::byte>(rows_a[i], f).data(), b.cell<std::byte>(rows_b[i], f).data(),
          [&](const StateField& field, std::size_t column, const StateValue& x, const StateValue& y) {
            if (found.bodies == 0 && !differs) {
              found.body = id;
              found.field = field_text(field, column);
              found.first = x;
              found.second = y;
            }
            differs = true;
          });
    }
    found.bodies += differs;
  }
  return found;
}

/// Adds the difference `other` to `into`. The two are differences in two tables of one component, which has
/// one table per body type. The result shows the value of the body with the lower id. Its member `bodies` is
/// 0 if that of `into` or `other` is 0.
void merge(ComponentDifference& into, const ComponentDifference& other) {
  if (into.bodies == 0 || other.bodies == 0) {
    into.bodies = 0;
    return;
  }
  const std::size_t bodies = into.bodies + other.bodies;
  if (other.body < into.body) into = other;
  into.bodies = bodies;
}

/// Position of a hash group in the order of cause and effect: readings change memories, memories change
/// commands and velocities, and these change poses. Differences are sorted by this position, so that the
/// first difference is nearest to the cause.
int phase_order(HashGroup group) {
  switch (group) {
    case HashGroup::sensor: return 0;
    case HashGroup::memory: return 1;
    case HashGroup::velocity: return 2;
    case HashGroup::pose: break;
  }
  return 3;
}

}  // namespace

std::string value_text(const StateValue& value) {
  return fmt::format("0x{:0{}x} ({})", value.bits, 2 * element_size(value.element), decimal(value));
}

std::string field_text(const StateField& field, std::size_t column) {
  return field.columns == 1 ? field.name : fmt::format("{}[{}]", field.name, column);
}

void compare_rows(std::span<const StateField> fields, const std::byte* first, const std::byte* second,
                  const ReportValue& report) {
  for (const StateField& field : fields)
    compare_fields(field, first + field.offset, second + field.offset, report);
}

std::vector<ComponentDifference> state_differences(World& first, World& second) {
  const auto group_order = [](const ComponentDifference& known) { return phase_order(known.group); };
  std::vector<ComponentDifference> found;
  if (first.tables().size() != second.tables().size()) {
    found.push_back({.component = "the list of components"});
    return found;
  }
  for (std::size_t t = 0; t < first.tables().size(); ++t) {
    const StateTable& a = first.tables()[t];
    const StateTable& b = second.tables()[t];
    if (hash_rows(first.parallel(), a, {0, a.rows()}) == hash_rows(second.parallel(), b, {0, b.rows()}))
      continue;
    const ComponentDifference difference = table_difference(a, b);
    const auto known = std::ranges::find(found, difference.component, &ComponentDifference::component);
    if (known == found.end())
      found.insert(std::ranges::upper_bound(found, phase_order(difference.group), {}, group_order),
                   difference);
    else
      merge(*known, difference);
  }
  return found;
}

std::string difference_text(const World& world, const ComponentDifference& difference) {
  if (difference.bodies == 0)
    return fmt::format("{}: the states have different bodies or fields", difference.component);
  return fmt::format(
      "{}: {} of \"{}\" (id {}) is {}, not {}; {}", difference.component, difference.field,
      world.spec().name(difference.body), difference.body.value, value_text(difference.second),
      value_text(difference.first),
      difference.bodies == 1 ? "1 body differs" : fmt::format("{} bodies differ", difference.bodies));
}

}  // namespace troupe::engine
