#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace troupe::partition {

/// For each mask of kLanes lanes, the permutation that moves the selected lanes to the front and keeps their
/// order: the source of each lane, or of each of its bytes. The remaining lanes come from the first one.
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

/// Sources by lane, for eight lanes: 2 KiB. Four bits per lane would halve that but cost two more
/// instructions.
alignas(64) inline constexpr auto k_compress_lanes = compress_table<8, 1>();
/// Sources by byte, for four lanes of four bytes.
alignas(64) inline constexpr auto k_compress_bytes = compress_table<4, 4>();

}  // namespace troupe::partition
