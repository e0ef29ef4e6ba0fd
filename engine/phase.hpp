#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// The phases of a tick, in their order.
enum class Phase : std::uint8_t {
  sense,   ///< sensors that are due read the state of the last tick
  decide,  ///< controllers map percepts and memories to commands
  move,    ///< drives, joints and effects; conflicts are settled; births and deaths
  index,   ///< whoever moved is put where it is now in the sparse grid
};
inline constexpr std::size_t k_phases = 4;  ///< values of Phase
std::string_view phase_name(Phase phase);   ///< "sense", ...: as profiles call it

}  // namespace troupe::engine
