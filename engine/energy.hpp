#pragma once

namespace troupe::engine {

inline constexpr double k_most_watts = 1e9;    ///< greatest power that a world may give
inline constexpr double k_most_mass_kg = 1e6;  ///< greatest mass that a world may give

/// Energy that a device stores, J, and what has gone through it since tick 0.
struct Energy {
  double stored_j = 0;      ///< what it holds
  double capacity_j = 0;    ///< what it can hold
  double dissipated_j = 0;  ///< by all that runs on it
  double received_j = 0;    ///< from others, by contact
  double given_j = 0;       ///< to others, by contact
  bool infinite = false;    ///< it never runs out; stored_j stays 0
  bool charging = false;    ///< it was given something in the last tick

  /// Of its capacity, 0 to 1; 1 where it is infinite.
  double proportion_remaining() const {
    if (infinite) return 1;
    return capacity_j > 0 ? stored_j / capacity_j : 0;
  }
};

}  // namespace troupe::engine
