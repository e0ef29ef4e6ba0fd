#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// Method by which rangers compute their ranges (docs/sensing.md). The method `grid` rasterises all outlines
/// into a grid of square cells, and follows each ray from cell to cell.
enum class RangingEngine : std::uint8_t {
  exact,  ///< exact distance to the first edge of an outline
  grid,   ///< distance to the first occupied cell, quantised to WorldSpec::resolution_m
};

/// Names in world files and on the command line, in the order of the enumeration.
inline constexpr std::array<std::string_view, 2> k_ranging_engines{"exact", "grid"};

/// Name of an engine, from k_ranging_engines.
inline std::string_view ranging_engine_name(RangingEngine engine) {
  return k_ranging_engines[static_cast<std::size_t>(engine)];
}

/// Default edge of the grid's cells, m. Stage has the same default.
inline constexpr double k_resolution_m = 0.02;
inline constexpr double k_min_resolution_m = 1e-4;  ///< smallest edge of the grid's cells, m
inline constexpr double k_max_resolution_m = 100;   ///< largest edge of the grid's cells, m

}  // namespace troupe::engine
