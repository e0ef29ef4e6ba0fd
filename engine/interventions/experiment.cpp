#include "engine/interventions/experiment.hpp"

#include "base/sort.hpp"
#include "engine/spec/ticks.hpp"

#include <algorithm>
#include <tuple>

namespace troupe::engine {

std::vector<std::size_t> order_of_interventions(const ExperimentSpec& spec, double tick_s) {
  std::vector<std::uint64_t> ticks;
  for (const InterventionSpec& at : spec.at) ticks.push_back(ticks_until(at.time_s, tick_s));
  return sorted_order(ticks);
}

std::span<const Candidate> Experiment::choose(const GroupSpec& group) {
  std::vector<Candidate>& all = candidates;
  const std::size_t count = group.selected_of(all.size());
  if (count < all.size()) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
    std::ranges::nth_element(all, end, {}, [](const Candidate& c) { return std::tuple(c.key, c.body); });
  }
  // Candidates of other ranks are not in the order of ids.
  std::sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count),
            [](const auto& a, const auto& b) { return a.body < b.body; });
  return {all.data(), count};
}

}  // namespace troupe::engine
