#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// The phases of a tick, in their order.
enum class Phase : std::uint8_t {
  intervene,  ///< interventions and faults of the world's file, then changes by programs and users
  sense,      ///< due sensors read the state of the last tick
  actuate,    ///< commands of the last tick become velocities; devices carry out theirs
  decide,     ///< controllers turn readings, memory and random numbers into new commands
  move,       ///< bodies and joints move unless blocked; then effects, deaths and births
  index,      ///< the spatial index of all bodies is rebuilt
};
inline constexpr std::size_t k_phases = 6;  ///< number of phases
std::string_view phase_name(Phase phase);   ///< "sense", ...: name in profiles

}  // namespace troupe::engine
