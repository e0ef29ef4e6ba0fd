#pragma once

#include <cstddef>
#include <random>

/// Random choices for the mutators, which change the inputs of fuzz tests at random. All functions take their
/// random numbers from a generator with a given seed. A mutation therefore depends only on the input and the
/// seed.
namespace troupe::fuzz {

using Random = std::minstd_rand;

/// Returns a random number from 0 to count - 1; 0 if `count` is 0.
inline std::size_t below(Random& random, std::size_t count) { return count == 0 ? 0 : random() % count; }
/// Returns true with a probability of `percent` per cent.
inline bool chance(Random& random, unsigned percent) { return random() % 100 < percent; }

/// Returns a random element of a list, which must not be empty.
template <class List>
auto& any_of(List& list, Random& random) {
  return list[below(random, list.size())];
}

}  // namespace troupe::fuzz
