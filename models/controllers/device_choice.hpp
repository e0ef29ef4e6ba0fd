#pragma once

#include "base/result.hpp"
#include "engine/kinds/kinds.hpp"
#include "models/controllers/scan_ahead.hpp"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::models {

/// Helps a controller to select (claim) the sensors and other devices of its body that it uses, one after
/// another. The function choose() of a controller makes this selection when the world is loaded.
class DeviceChoice {
 public:
  /// devices: the devices of the body. claimed: one entry per device, true if a controller uses the device;
  /// the functions below set the entries of the devices that they claim. Both arguments must outlive this
  /// object.
  DeviceChoice(std::span<const engine::DeviceInfo> devices, std::vector<bool>& claimed)
      : devices_(devices), claimed_(claimed) {}

  /// Claims the first unclaimed device for which fits(device) is true. Returns false if there is none.
  template <class Fits>
  bool take(Fits&& fits) {
    for (std::size_t d = 0; d < devices_.size(); ++d) {
      if (claimed_[d] || !fits(devices_[d])) continue;
      claimed_[d] = true;
      chosen_.push_back(d);
      return true;
    }
    return false;
  }
  /// Claims the first unclaimed device of this kind. Returns false if there is none.
  bool take_kind(std::string_view kind) {
    return take([kind](const engine::DeviceInfo& device) { return device.kind == kind; });
  }
  /// Claims an unclaimed ranger (range sensor) that sees ahead (Scanner::is_usable), and returns a Scanner,
  /// an object that detects obstacles in the readings of this ranger. The function takes the first such
  /// ranger that has a transducer (fan of beams) with k_least_samples or more beams, as in Stage. If there is
  /// none, it takes the first such ranger whose transducers together have k_least_samples or more beams. If
  /// no ranger can be used, the error states the reason for each ranger of the robot. share: 3 or 4; the
  /// scanner leaves out 1 / share of the beams at either end of the scan when it looks ahead (Scanner).
  Result<Scanner> take_scanner(std::size_t share);
  /// Claims a ground sensor, a radio and a scanner (take_scanner), in this order, and returns the scanner.
  /// Returns an error if one of the three is missing; the devices claimed up to then stay claimed. share: as
  /// for take_scanner().
  Result<Scanner> take_ground_radio_scanner(std::size_t share);
  /// Indices of the claimed devices, in the order in which they were claimed.
  const std::vector<std::size_t>& chosen() const { return chosen_; }

 private:
  static bool has_fan(const engine::DeviceInfo& device);
  Error no_scanner() const;

  std::span<const engine::DeviceInfo> devices_;
  std::vector<bool>& claimed_;
  std::vector<std::size_t> chosen_;
};

}  // namespace troupe::models
