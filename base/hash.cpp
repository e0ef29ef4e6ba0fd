#include "base/hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe {
namespace {

// Number of rows that are copied into a buffer before the first of them is hashed. A load that spans several
// recent stores waits until these have reached the cache. If each row were hashed right after its copy, it
// would wait for its own stores and take 10 ns instead of 4.
constexpr std::size_t k_gathered = 16;

/// The sum of the hashes of at most k_gathered rows, each preceded by its id. `room` is a buffer for these
/// rows and ids. Size is std::size_t or an integral constant. With a constant the compiler turns the copies
/// into moves and removes all branches of the hash.
template <class Size>
std::uint64_t hash_few(std::byte* room, std::span<const BodyId> ids, const std::byte* first,
                       std::size_t stride, Size bytes, std::uint64_t seed) {
  const std::size_t width = sizeof(BodyId) + bytes;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    std::memcpy(room + i * width, &ids[i], sizeof(BodyId));
    if (bytes > 0)  // rows may be empty
      std::memcpy(room + i * width + sizeof(BodyId), first + i * stride, bytes);
  }
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) sum += XXH3_64bits_withSeed(room + i * width, width, seed);
  return sum;
}

template <class Size>
std::uint64_t hash_all(std::byte* room, std::span<const BodyId> ids, const std::byte* first,
                       std::size_t stride, Size bytes, std::uint64_t seed) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < ids.size(); i += k_gathered)
    sum += hash_few(room, ids.subspan(i, std::min(k_gathered, ids.size() - i)), first + i * stride, stride,
                    bytes, seed);
  return sum;
}

using HashRows = std::uint64_t (*)(std::span<const BodyId>, const std::byte*, std::size_t, std::uint64_t);

template <std::size_t bytes>
std::uint64_t hash_rows_of(std::span<const BodyId> ids, const std::byte* first, std::size_t stride,
                           std::uint64_t seed) {
  std::array<std::byte, (sizeof(BodyId) + bytes) * k_gathered> room;
  return hash_all(room.data(), ids, first, stride, std::integral_constant<std::size_t, bytes>(), seed);
}

constexpr std::size_t k_widest = 64;  // bytes, such as the ranges of sixteen beams

/// The functions hash_rows_of() for rows of up to k_widest bytes, indexed by the size of a row in four-byte
/// words.
constexpr auto k_hash_rows = []<std::size_t... words>(std::index_sequence<words...>) {
  return std::array<HashRows, sizeof...(words)>{&hash_rows_of<4 * words>...};
}
(std::make_index_sequence<k_widest / 4 + 1>());

}  // namespace

std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::uint64_t hash_text(std::string_view text) { return hash_bytes(std::as_bytes(std::span(text))); }

std::uint64_t hash_rows(std::span<const BodyId> ids, const std::byte* first, std::size_t stride,
                        std::size_t bytes, std::uint64_t seed) {
  if (bytes == 1) return hash_rows_of<1>(ids, first, stride, seed);
  if (bytes <= k_widest && bytes % 4 == 0) return k_hash_rows[bytes / 4](ids, first, stride, seed);
  std::vector<std::byte> room(k_gathered * (sizeof(BodyId) + bytes));
  return hash_all(room.data(), ids, first, stride, bytes, seed);
}

struct HashStream::State {
  XXH3_state_t xxh3;
};

HashStream::HashStream() : state_(std::make_unique<State>()) { XXH3_64bits_reset(&state_->xxh3); }
HashStream::~HashStream() = default;

void HashStream::add(std::span<const std::byte> bytes) {
  XXH3_64bits_update(&state_->xxh3, bytes.data(), bytes.size());
}

std::uint64_t HashStream::hash() const { return XXH3_64bits_digest(&state_->xxh3); }

std::string hex(std::uint64_t value) {
  constexpr std::string_view k_digits = "0123456789abcdef";
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) text[i] = k_digits[value & 15];
  return text;
}

}  // namespace troupe
