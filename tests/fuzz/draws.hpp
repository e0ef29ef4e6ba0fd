#pragma once

#include <cstddef>
#include <random>

/// Random choices of the mutators. They draw from a generator with a given seed, so that a mutation is a pure
/// function of its input and its seed.
namespace troupe::fuzz {

using Random = std::minstd_rand;

/// A random number from 0 to count - 1; 0 if count is 0.
inline std::size_t below(Random& random, std::size_t count) { return count == 0 ? 0 : random() % count; }
/// True with this probability, in per cent.
inline bool chance(Random& random, unsigned percent) { return random() % 100 < percent; }

/// A random element of a list, which must not be empty.
template <class List>
auto& any_of(List& list, Random& random) {
  return list[below(random, list.size())];
}

}  // namespace troupe::fuzz
