#pragma once

#include "base/ids.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace troupe {

/// Returns the 64-bit XXH3 hash of the bytes, which is the same on every platform. A different seed gives a
/// different hash of the same bytes.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed = 0);
/// Returns the hash of a text: hash_bytes() of its characters, with seed 0.
std::uint64_t hash_text(std::string_view text);

/// Hashes a table that has one row per body. The result does not depend on the order of the rows, because it
/// is the sum, modulo 2^64, of one hash per row. The hash of a row is hash_bytes(), with `seed`, of the
/// four-byte id of the body followed by the bytes of the row. The sum is 0 without rows.
///
/// Rows of 1 byte, and rows whose size is a multiple of four bytes up to 64, take a few ns each. For other
/// sizes the function is slower and allocates a buffer.
///
/// ids: for each row, the id of its body
/// first, stride: row i starts at first + i * stride; the stride is in bytes
/// bytes: number of bytes per row
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
