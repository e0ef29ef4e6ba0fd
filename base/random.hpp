#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace troupe {

/// The random number generator Philox4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as
/// 1, 2, 3; SC 2011). The function is pure: the same counter and key give the same four random words on every
/// machine.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

/// Returns the number of a random stream. A stream is an independent sequence of random numbers. Each use of
/// random numbers has a stream of its own: for example, adding a noisy sensor does not change the random
/// numbers of other sensors. The number is a 32-bit hash of two names, so two streams coincide only if their
/// hashes happen to be equal.
///
/// kind: name of an implementation, such as the sensor `ranger`
/// instance: name of one use of the kind in a robot, such as `laser`
std::uint32_t stream_id(std::string_view kind, std::string_view instance);

/// A sequence of random numbers for one entity (usually a body, by its id), in one stream (see stream_id()),
/// at one tick (time step). A draw is one 32-bit number of the sequence. Draw k depends only on the seed, the
/// stream, the entity, the tick and k, so no generator state is kept between ticks.
class Random {
 public:
  /// Creates the sequence; the next draw is draw 0.
  Random(std::uint64_t seed, std::uint32_t stream, std::uint32_t entity, std::uint32_t tick);

  /// Returns 32 uniform random bits; uses one draw.
  std::uint32_t bits();
  /// Returns a uniformly distributed number in [0, 1) with 53 random bits; uses two draws.
  double uniform();
  /// Returns a uniformly distributed number in [low, high); uses two draws. If `high` is not above `low`,
  /// returns `low`. high - low must be finite.
  double uniform(double low, double high);
  /// Returns a uniformly distributed integer from 0 to n - 1, without bias; n must be positive. Usually uses
  /// one draw. With a probability below n / 2^32, a draw is rejected and the function uses another one.
  std::uint32_t below(std::uint32_t n);
  /// Returns a normally distributed number with mean 0 and standard deviation 1 (Box-Muller); uses four
  /// draws.
  double normal();
  /// Returns an exponentially distributed number with mean 1; uses two draws.
  double exponential();
  /// Permutes the items; all permutations are equally likely (Fisher-Yates). Uses about one draw per item.
  /// Sequence must be a type with size() and operator[]. There must be fewer than 2^32 items.
  template <class Sequence>
  void shuffle(Sequence& items) {
    for (std::uint32_t n = static_cast<std::uint32_t>(items.size()); n > 1; --n) {
      using std::swap;
      swap(items[n - 1], items[below(n)]);
    }
  }

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;  // {number of the next block, stream, entity, tick}
  std::array<std::uint32_t, 4> block_{};  // the four draws that one call of philox4x32() gives
  unsigned left_ = 0;                     // number of draws of block_ that are not used yet
};

/// Mixes the bits of x: a bijection in which every bit of the result depends on every bit of x. It is the
/// finaliser of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
inline std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Appends a value to a sequence of values, and returns the 64-bit hash of the longer sequence. Every bit of
/// the result depends on every bit of `mixture` and `value`.
///
/// mixture: the hash of the sequence before; 0 if it is empty
inline std::uint64_t mix_in(std::uint64_t mixture, std::uint64_t value) {
  constexpr std::uint64_t k_step = 0x9e3779b97f4a7c15;  // 2^64 over the golden ratio, SplitMix64's increment
  return scramble(mixture + value + k_step);
}

/// Returns a 64-bit hash of a seed and the number of a tick. Every bit of the result depends on every bit of
/// both.
inline std::uint64_t mix(std::uint64_t seed, std::uint64_t tick) { return mix_in(mix_in(0, seed), tick); }
/// Returns a 64-bit hash of a seed, the number of a tick and the id of a body. Every bit of the result
/// depends on every bit of the three numbers. In each tick, conflicts between the motions of bodies are
/// resolved in the order of these hashes. The order therefore differs from tick to tick.
inline std::uint64_t mix(std::uint64_t seed, std::uint64_t tick, std::uint64_t id) {
  return mix_in(mix(seed, tick), id);
}

}  // namespace troupe
