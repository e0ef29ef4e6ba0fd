#include "engine/spec/experiment_spec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe::engine {

bool holds(double a, Comparison comparison, double b) {
  if (std::isnan(a) || std::isnan(b)) return false;
  switch (comparison) {
    case Comparison::below: return a < b;
    case Comparison::at_most: return a <= b;
    case Comparison::above: return a > b;
    case Comparison::at_least: return a >= b;
    case Comparison::equal: return a == b;
    case Comparison::unequal: break;
  }
  return a != b;
}

std::string text_of(const StopSpec& condition) {
  const MeasureSpec& measure = condition.measure;
  std::string name = measure.name;
  if (name.empty()) name = measure.of.empty() ? measure.kind : fmt::format("{}:{}", measure.kind, measure.of);
  return fmt::format("{} {} {}", name, k_comparisons[static_cast<std::size_t>(condition.comparison)],
                     condition.value);
}

std::size_t GroupSpec::selected_of(std::size_t size) const {
  std::size_t selected = size;
  if (count) selected = std::min(selected, static_cast<std::size_t>(*count));
  if (share)
    selected =
        std::min(selected, static_cast<std::size_t>(std::floor(*share * static_cast<double>(size) + 0.5)));
  return selected;
}

Record changed(const Record& params, const SettingSpec& setting) {
  Record changed = params;
  for (std::size_t i = 0; i < setting.params.size(); ++i)
    if (setting.params[i].given()) changed[i] = setting.params[i];
  return changed;
}

}  // namespace troupe::engine
