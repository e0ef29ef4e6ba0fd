#pragma once

namespace troupe {

// Limits of the values in world files that the readers of several formats check. Each limit is given once,
// here or in the description of a field (engine/fields/fields.hpp).

/// Largest absolute value of a coordinate, m, both in world files and in the state of a simulation
/// (engine::pose_fields()).
inline constexpr double k_world_reach_m = 100e3;
/// Largest absolute value of a coordinate or length in a WorldSpec that a program made or a file stores, m:
/// ten times that of the largest world, and cell numbers still fit 32 bits.
inline constexpr double k_spec_reach_m = 10 * k_world_reach_m;
/// Shortest tick (time step), s. It is one microsecond, the resolution of the clock of the simulator Stage,
/// whose world files Troupe reads.
inline constexpr double k_least_tick_s = 1e-6;
inline constexpr double k_most_tick_s = 3600;  ///< longest tick, s
/// Longest period (time between two updates) of a device, drive or controller, s.
inline constexpr double k_most_period_s = 1e6;
/// Largest absolute value of the parameter `ranger_return` of a body: the intensity (without unit) that range
/// sensors report for a surface of the body.
inline constexpr double k_most_ranger_return = 1e6;

}  // namespace troupe
