#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace troupe::partition {

/// Makes a table of permutations that move selected lanes (elements) of a SIMD vector to its front, in their
/// order. A bit mask selects the lanes: bit i stands for lane i. The table holds one permutation for each
/// mask of kLanes bits, in ascending order of the masks.
///
/// A permutation has kLanes * kBytes entries. If kBytes is 1, entry k is the index of the lane that moves to
/// lane k, whatever the size of a lane. Otherwise, a lane has kBytes bytes, and entry k is the index of the
/// byte that moves to byte k. The unused entries at the end are 0.
///
/// For example, the mask 0b1010 selects the lanes 1 and 3. Its permutation is {1, 3, 0, 0} in the table
/// compress_table<4, 1>(), and {2, 3, 6, 7, 0, 0, 0, 0} in the table compress_table<4, 2>().
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

/// Permutations of the lanes of vectors of eight lanes. The table takes 2 KiB. Two entries per byte would
/// halve its size, but would cost two more instructions per use.
alignas(64) inline constexpr auto k_compress_lanes = compress_table<8, 1>();
/// Permutations of the bytes of vectors of four lanes of four bytes.
alignas(64) inline constexpr auto k_compress_bytes = compress_table<4, 4>();

}  // namespace troupe::partition
