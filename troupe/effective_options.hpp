#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace troupe {

/// Returns true for the keys of Simulation::effective_options() that do not affect the simulated results.
/// They state how the run is computed (number of threads, ...), or at which tick it was resumed.
constexpr bool changes_no_result(std::string_view option) {
  constexpr std::array<std::string_view, 5> k_options{"threads", "tile_m", "simd", "ranks",
                                                      "resumed_at_tick"};
  return std::ranges::find(k_options, option) != k_options.end();
}

}  // namespace troupe
