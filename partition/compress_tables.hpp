#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace troupe::partition {

/// Makes a table with one permutation for each mask of kLanes lanes, in the order of the masks. The
/// permutation moves the lanes that the mask selects to the front of a SIMD vector and keeps their order. If
/// kBytes is 1, it lists the source of each lane; otherwise it lists the source of each of the kBytes bytes
/// of each lane. The entries after those of the selected lanes are 0.
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

/// The table of the sources of lanes, for vectors of eight lanes. It takes 2 KiB. Four bits per lane would
/// halve the size but cost two more instructions.
alignas(64) inline constexpr auto k_compress_lanes = compress_table<8, 1>();
/// The table of the sources of bytes, for vectors of four lanes of four bytes.
alignas(64) inline constexpr auto k_compress_bytes = compress_table<4, 4>();

}  // namespace troupe::partition
