#include "apps/ranks/rank_place.hpp"

#include <algorithm>

namespace troupe::apps {

unsigned count_sharing(const std::vector<RankPlace>& places, std::size_t rank) {
  return static_cast<unsigned>(std::ranges::count_if(places, [&](const RankPlace& place) {
    return place.host == places[rank].host && place.processors == places[rank].processors;
  }));
}

}  // namespace troupe::apps
