#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// What finds the ranges of a world: exact geometry, or a walk through the cells that outlines are drawn into
/// (docs/sensing.md).
enum class RangingEngine : std::uint8_t {
  exact,  ///< the distance to the first edge, computed
  grid,   ///< to the first occupied cell: quantised to `resolution`
};

/// As world files and the command line write them, in the order of the enumeration.
inline constexpr std::array<std::string_view, 2> k_ranging_engines{"exact", "grid"};

/// One of k_ranging_engines.
inline std::string_view ranging_engine_name(RangingEngine engine) {
  return k_ranging_engines[static_cast<std::size_t>(engine)];
}

/// Edge of the grid's cells where a world says nothing else: that of Stage.
inline constexpr double k_resolution_m = 0.02;
inline constexpr double k_min_resolution_m = 1e-4;  ///< the finest that a world may ask for
inline constexpr double k_max_resolution_m = 100;   ///< the coarsest

}  // namespace troupe::engine
