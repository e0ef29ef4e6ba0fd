#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// The phases of a tick, in their order.
enum class Phase : std::uint8_t {
  sense,   ///< sensors that are due read the state of the last tick
  decide,  ///< drives make velocities, devices carry out what was asked, controllers decide
  move,    ///< bodies and joints go where nothing is in the way; effects, deaths and births follow
  index,   ///< bodies that moved are entered into the index where they are now
};
inline constexpr std::size_t k_phases = 4;  ///< values of Phase
std::string_view phase_name(Phase phase);   ///< "sense", ...: as profiles call it

}  // namespace troupe::engine
