#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// The phases of a tick, in their order.
enum class Phase : std::uint8_t {
  sense,   ///< due sensors read the state of the last tick
  decide,  ///< drives compute velocities, devices execute commands, controllers decide
  move,    ///< bodies and joints move unless blocked; then effects, deaths and births
  index,   ///< the spatial index of all bodies is rebuilt
};
inline constexpr std::size_t k_phases = 4;  ///< number of phases
std::string_view phase_name(Phase phase);   ///< "sense", ...: name in profiles

}  // namespace troupe::engine
