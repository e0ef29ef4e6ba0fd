#include "engine/kinds/effects.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tuple>

namespace troupe::engine {

void Effects::reserve(std::size_t most) {
  effects_ = std::make_unique<Effect[]>(most);
  most_ = most;
  count_ = 0;
}

void Effects::emit(const Effect& effect) {
  const std::size_t at = count_.fetch_add(1, std::memory_order_relaxed);
  if (at >= most_)
    throw std::length_error("the devices of the world emitted more effects in a tick than the " +
                            std::to_string(most_) +
                            " that their kinds declare for all devices together: set a larger "
                            "DeviceKind::Prepared::most_effects in the kind whose devices emit too many");
  effects_[at] = effect;
}

std::span<const Effect> Effects::sorted() {
  const std::span<Effect> all(effects_.get(), count_);
  std::ranges::sort(all, {}, [](const Effect& e) { return std::tuple(e.source, e.device, e.sequence); });
  return all;
}

}  // namespace troupe::engine
