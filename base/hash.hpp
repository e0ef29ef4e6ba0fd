#pragma once

#include "base/ids.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace troupe {

/// XXH3, 64 bits: the same value on every platform.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed = 0);
/// hash_bytes() of the characters, seed 0.
std::uint64_t hash_text(std::string_view text);

/// The sum, modulo 2^64, of the hashes of rows: for each id hash_bytes() of its four bytes followed by those
/// of its row. Row i lies at first + i * stride and has `bytes` bytes. cost    some ns a row: rows of few
/// bytes, in multiples of four, are hashed by code of their own
std::uint64_t hash_rows(std::span<const BodyId> ids, const std::byte* first, std::size_t stride,
                        std::size_t bytes, std::uint64_t seed);

/// The hash_bytes() of what comes piece by piece.
class HashStream {
 public:
  HashStream();  ///< of no bytes
  ~HashStream();
  HashStream(const HashStream&) = delete;
  HashStream& operator=(const HashStream&) = delete;
  /// Appends to what was added before; where it is cut does not matter.
  void add(std::span<const std::byte> bytes);
  std::uint64_t hash() const;  ///< of all so far; may be asked for between pieces

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 16 lower-case hex digits.
std::string hex(std::uint64_t value);

}  // namespace troupe
