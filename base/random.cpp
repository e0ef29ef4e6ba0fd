#include "base/random.hpp"

#include "base/assert.hpp"
#include "base/hash.hpp"
#include "base/math.hpp"

#include <string>

namespace troupe {

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) {
  // The constants are those of table 2 and section 4.2 of the paper. The steps of the key are the golden
  // ratio minus 1 and sqrt(3) - 1, both times 2^32.
  constexpr std::uint64_t k_factor_0 = 0xd2511f53;
  constexpr std::uint64_t k_factor_1 = 0xcd9e8d57;
  constexpr std::uint32_t k_step_0 = 0x9e3779b9;
  constexpr std::uint32_t k_step_1 = 0xbb67ae85;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product_0 = k_factor_0 * counter[0];
    const std::uint64_t product_1 = k_factor_1 * counter[2];
    counter = {static_cast<std::uint32_t>(product_1 >> 32) ^ counter[1] ^ key[0],
               static_cast<std::uint32_t>(product_1),
               static_cast<std::uint32_t>(product_0 >> 32) ^ counter[3] ^ key[1],
               static_cast<std::uint32_t>(product_0)};
    key[0] += k_step_0;
    key[1] += k_step_1;
  }
  return counter;
}

std::uint32_t stream_id(std::string_view kind, std::string_view instance) {
  std::string name(kind);
  name += '\0';  // so that ("ab", "c") and ("a", "bc") differ
  name += instance;
  const std::uint64_t hash = hash_text(name);
  return static_cast<std::uint32_t>(hash ^ (hash >> 32));
}

Random::Random(std::uint64_t seed, std::uint32_t stream, std::uint32_t entity, std::uint32_t tick)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, stream, entity, tick} {}

std::uint32_t Random::bits() {
  if (left_ == 0) {
    block_ = philox4x32(counter_, key_);
    ++counter_[0];
    left_ = 4;
  }
  return block_[4 - left_--];
}

double Random::uniform() {
  const std::uint64_t high = bits() >> 5;  // 27 bits
  const std::uint64_t low = bits() >> 6;   // 26 bits
  return static_cast<double>((high << 26) | low) * 0x1p-53;
}

double Random::uniform(double low, double high) {
  const double value = low + (high - low) * uniform();
  return value < high ? value : low;  // the sum may round up to high
}

std::uint32_t Random::below(std::uint32_t n) {
  TROUPE_ASSERT(n > 0);
  // Lemire, Fast random integer generation in an interval, 2019: the upper half of bits * n is the result.
  // A product whose lower half is below 2^32 mod n is rejected, so that every result comes from the same
  // number of values of bits().
  std::uint64_t product = static_cast<std::uint64_t>(bits()) * n;
  if (static_cast<std::uint32_t>(product) < n) {
    const std::uint32_t surplus = (0u - n) % n;
    while (static_cast<std::uint32_t>(product) < surplus) product = static_cast<std::uint64_t>(bits()) * n;
  }
  return static_cast<std::uint32_t>(product >> 32);
}

double Random::normal() {
  const double radius = sqrt(-2.0 * log(1.0 - uniform()));  // 1 - uniform() lies in (0, 1]
  return radius * cos(2.0 * k_pi * uniform());
}

double Random::exponential() { return -log(1.0 - uniform()); }

}  // namespace troupe
