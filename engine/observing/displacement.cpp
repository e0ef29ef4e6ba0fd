#include "engine/observing/displacement.hpp"

#include "base/exact_sum.hpp"

#include <cstddef>

namespace troupe::engine {

double mean_displacement(const World& world) {
  world.require_whole();
  const CommittedView& view = world.view();
  const auto robots = static_cast<double>(world.lives().robots());
  ExactSum sum;
  for (std::size_t r = 0; r < view.rows(); ++r)
    if (view.type(Row(r)).drive && view.is_there(Row(r)))
      sum.add((view.transform(Row(r)).position - view.origin(Row(r))).norm());
  return robots > 0 ? sum.value() / robots : 0;
}

}  // namespace troupe::engine
