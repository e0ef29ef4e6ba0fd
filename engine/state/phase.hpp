#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// The phases of a tick (a time step), in their order. An intervention is a change of the world at a given
/// time, such as removing robots. A fault is a random failure of a robot. A sensor is *due* once per period.
/// An effect is an action of a device on another body, such as gripping it.
enum class Phase : std::uint8_t {
  intervene,  ///< interventions and faults of the world file, then the callback of World::before_tick()
  sense,      ///< sensors that are due read the state after the last tick, as changed by `intervene`
  actuate,    ///< drives turn the commands of the last tick into velocities; devices execute their commands
  decide,     ///< controllers compute new commands from readings, memory and random numbers
  move,       ///< bodies and joints move unless blocked; then effects of devices, deaths and births follow
  index,      ///< the spatial index of all bodies is rebuilt
};
inline constexpr std::size_t k_phases = 6;  ///< number of phases
/// Name of a phase, such as "sense".
constexpr std::string_view phase_name(Phase phase) {
  constexpr std::string_view k_names[k_phases] = {"intervene", "sense", "actuate", "decide", "move", "index"};
  return k_names[static_cast<std::size_t>(phase)];
}

}  // namespace troupe::engine
