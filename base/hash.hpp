#pragma once

#include "base/ids.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace troupe {

/// The 64-bit XXH3 hash of the bytes, which is the same on every platform. Different seeds give different
/// hashes of the same bytes.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed = 0);
/// Hashes a text: hash_bytes() of its characters with seed 0.
std::uint64_t hash_text(std::string_view text);

/// Hashes the rows of a table that has one row per body. The result does not depend on the order of the rows:
/// it is the sum, modulo 2^64, of the hashes of all rows. Row i belongs to the body with the id ids[i],
/// starts at first + i * stride (stride in bytes) and has `bytes` bytes. The hash of the row is hash_bytes(),
/// with `seed`, of the four-byte id followed by the bytes of the row. The number of rows is ids.size();
/// without rows the sum is 0. Costs a few ns per row. Rows of 1 byte, or of a multiple of four bytes up to
/// 64, are hashed by faster code; for other sizes the function allocates a buffer.
std::uint64_t hash_rows(std::span<const BodyId> ids, const std::byte* first, std::size_t stride,
                        std::size_t bytes, std::uint64_t seed);

/// Computes the hash of bytes that arrive in pieces. The result equals hash_bytes() of all bytes together,
/// with seed 0.
class HashStream {
 public:
  HashStream();  ///< a stream without bytes
  ~HashStream();
  HashStream(const HashStream&) = delete;
  HashStream& operator=(const HashStream&) = delete;
  /// Appends bytes. The hash does not depend on how the bytes are divided among calls.
  void add(std::span<const std::byte> bytes);
  std::uint64_t hash() const;  ///< the hash of all bytes added so far; more may follow

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Formats a value as 16 lower-case hexadecimal digits.
std::string hex(std::uint64_t value);

}  // namespace troupe
