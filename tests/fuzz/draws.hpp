#pragma once

#include <cstddef>
#include <random>

/// What the mutators draw with: a mutation is a pure function of its seed.
namespace troupe::fuzz {

using Random = std::minstd_rand;

/// 0 to count - 1; 0 where there is none.
inline std::size_t below(Random& random, std::size_t count) { return count == 0 ? 0 : random() % count; }
inline bool chance(Random& random, unsigned percent) { return random() % 100 < percent; }

/// An element of a list that is not empty.
template <class List>
auto& any_of(List& list, Random& random) {
  return list[below(random, list.size())];
}

}  // namespace troupe::fuzz
