#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace troupe::partition {

/// Makes a table with one permutation of the lanes (elements) of a SIMD vector for each bit mask of kLanes
/// bits, in ascending order of the masks. A permutation moves the lanes that its mask selects to the front of
/// the vector and keeps their order. If kBytes is 1, a permutation has one entry per lane of the result: the
/// index of the lane that moves to this place. Otherwise a lane has kBytes bytes, and a permutation has one
/// entry per byte of the result: the index of the byte that moves to this place. The entries after those of
/// the selected lanes are 0.
template <std::size_t kLanes, std::size_t kBytes>
constexpr std::array<std::uint8_t, (kLanes * kBytes) << kLanes> compress_table() {
  std::array<std::uint8_t, (kLanes * kBytes) << kLanes> table{};
  for (std::size_t mask = 0; mask < std::size_t{1} << kLanes; ++mask) {
    std::size_t to = mask * kLanes * kBytes;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      for (std::size_t byte = 0; byte < kBytes && (mask >> lane & 1) != 0; ++byte)
        table[to++] = static_cast<std::uint8_t>(lane * kBytes + byte);
  }
  return table;
}

/// The permutations by lanes, for vectors of eight lanes. The table takes 2 KiB. Entries of four bits instead
/// of eight would halve its size but cost two more instructions per use.
alignas(64) inline constexpr auto k_compress_lanes = compress_table<8, 1>();
/// The permutations by bytes, for vectors of four lanes of four bytes.
alignas(64) inline constexpr auto k_compress_bytes = compress_table<4, 4>();

}  // namespace troupe::partition
