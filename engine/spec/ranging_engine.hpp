#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// Method by which rangers (range sensors) compute their ranges (docs/sensing.md). The method `grid`
/// rasterises the outlines of all bodies and walls into a grid of square cells, and follows each ray from
/// cell to cell.
enum class RangingEngine : std::uint8_t {
  exact,  ///< exact distance to the first edge of an outline
  grid,   ///< distance to the first occupied cell, in steps of the cell edge WorldSpec::resolution_m
};

/// Names of the methods in world files and on the command line, in the order of RangingEngine.
inline constexpr std::array<std::string_view, 2> k_ranging_engines{"exact", "grid"};

/// Name of a method, from k_ranging_engines.
inline std::string_view ranging_engine_name(RangingEngine engine) {
  return k_ranging_engines[static_cast<std::size_t>(engine)];
}

/// Default edge of the cells of RangingEngine::grid, m. The simulator Stage has the same default.
inline constexpr double k_resolution_m = 0.02;
inline constexpr double k_min_resolution_m = 1e-4;  ///< smallest allowed edge of the grid's cells, m
inline constexpr double k_max_resolution_m = 100;   ///< largest allowed edge of the grid's cells, m

}  // namespace troupe::engine
