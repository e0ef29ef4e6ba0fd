#include "engine/observing/stop_conditions.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::engine {
namespace {

bool same(const MeasureSpec& a, const MeasureSpec& b) {
  return a.kind == b.kind && a.name == b.name && a.of == b.of && a.params == b.params;
}

std::size_t column_of(const std::vector<MeasureSpec>& measures, const MeasureSpec& measure) {
  const auto found =
      std::ranges::find_if(measures, [&](const MeasureSpec& other) { return same(measure, other); });
  return static_cast<std::size_t>(found - measures.begin());
}

}  // namespace

StopConditions::Tested StopConditions::measures_of(std::span<const StopSpec> conditions) {
  Tested tested;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (column_of(tested.measures, conditions[i].measure) < tested.measures.size()) continue;
    tested.measures.push_back(conditions[i].measure);
    tested.paths.push_back(fmt::format("/stop_when/{}", i));
  }
  return tested;
}

StopConditions::StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                               Diagnostics& diagnostics)
    : StopConditions(world, registry, conditions, measures_of(conditions), diagnostics) {}

StopConditions::StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                               const Tested& tested, Diagnostics& diagnostics)
    : measures_(world, registry, tested.measures, diagnostics, tested.paths),
      values_(tested.measures.size()) {
  for (const StopSpec& condition : conditions)
    conditions_.push_back(
        {column_of(tested.measures, condition.measure), condition.comparison, condition.value});
}

void StopConditions::see() {
  measures_.see();
  ask();
}

void StopConditions::ask() {
  for (std::size_t column = 0; column < values_.size(); ++column) values_[column] = measures_.value(column);
  const auto found = std::ranges::find_if(conditions_, [this](const Condition& condition) {
    return holds(values_[condition.column], condition.comparison, condition.value);
  });
  holding_.reset();
  if (found != conditions_.end()) holding_ = static_cast<std::size_t>(found - conditions_.begin());
}

void StopConditions::begin() {
  measures_.see();
  holding_.reset();
}

std::vector<std::string> StopConditions::remember(std::span<const std::byte> memory) {
  std::vector<std::string> missing;
  for (const std::size_t column : measures_.remember(memory))
    if (measures_.has_memory(column)) missing.push_back(measures_.columns()[column]);
  return missing;
}

}  // namespace troupe::engine
