#pragma once

namespace troupe::engine {

inline constexpr double k_most_watts = 1e9;    ///< largest power that a world file may give, W
inline constexpr double k_most_mass_kg = 1e6;  ///< largest mass that a world file may give, kg

/// The energy account of a device that stores energy, such as a power pack. A power pack is a battery that
/// supplies devices, and possibly the drive, of its body. All energies are in J. `dissipated_j`, `received_j`
/// and `given_j` are sums since the body came into the world.
struct Energy {
  double stored_j = 0;      ///< energy stored now
  double capacity_j = 0;    ///< largest energy that the device can store; 0 if `infinite`
  double dissipated_j = 0;  ///< consumed by the device and by the devices and the drive that it supplies
  double received_j = 0;    ///< received from other bodies, by contact
  double given_j = 0;       ///< given to other bodies, by contact
  bool infinite = false;    ///< true: the supply never becomes empty; stored_j stays 0
  /// Whether the device received energy in the last tick (time step). If the device stops running, for
  /// example because its body is disabled, a value of true remains true until the device runs again.
  bool charging = false;

  /// Stored energy divided by the capacity, 0 to 1. If `infinite` is true, the result is 1. Otherwise, if the
  /// capacity is 0, the result is 0.
  double proportion_remaining() const {
    if (infinite) return 1;
    return capacity_j > 0 ? stored_j / capacity_j : 0;
  }
};

}  // namespace troupe::engine
