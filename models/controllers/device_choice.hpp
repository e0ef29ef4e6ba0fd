#pragma once

#include "base/result.hpp"
#include "engine/kinds/controller_kind.hpp"
#include "models/controllers/scan_ahead.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::models {

/// Helps the function choose() of a controller, which chooses the devices (sensors and other equipment of the
/// body) that the controller uses. choose() is called when the world is loaded. To claim a device means to
/// reserve it for one controller: the other controllers of the body that use this class then skip the device.
class DeviceChoice {
 public:
  /// devices: the devices that the controller may use
  /// claimed: one entry per element of `devices`, true if a controller has claimed the device. The functions
  ///     below set the entry to true when they claim a device
  ///
  /// Both arguments must outlive this object.
  DeviceChoice(std::span<const engine::DeviceInfo> devices, std::vector<bool>& claimed)
      : devices_(devices), claimed_(claimed) {}

  /// Claims the first unclaimed device for which fits(device) is true. Returns false if there is no such
  /// device.
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
  /// Claims the first unclaimed device of this kind. Returns false if there is no such device.
  bool take_kind(std::string_view kind) {
    return take([kind](const engine::DeviceInfo& device) { return device.kind == kind; });
  }
  /// Claims the first unclaimed radio whose messages can contain a payload of `bytes` bytes. Returns an error
  /// if there is no such radio. bytes: 2 or more
  Result<> take_radio(std::size_t bytes);
  /// Claims an unclaimed ranger (range sensor), and returns a Scanner, which detects obstacles in the
  /// readings of this ranger. Only rangers that see ahead (Scanner::is_usable()) are considered. If one of
  /// them has a transducer (fan of beams) with k_least_samples or more beams, the function takes the first
  /// ranger of this sort, as in Stage. Otherwise it takes the first ranger that sees ahead. If there is none,
  /// the error says for each ranger of the robot why it cannot be used.
  ///
  /// share: 3 or 4. The scanner looks ahead with the beams in the middle of the scan: it leaves out the
  ///     outermost 1 / `share` of the beams at either end (see Scanner)
  Result<Scanner> take_scanner(std::size_t share);
  /// Claims a ground sensor, a radio and a ranger, in this order. The ranger is chosen as by take_scanner().
  /// Returns the scanner. Returns an error if one of the three devices is missing; the devices that were
  /// claimed before stay claimed. share: as for take_scanner().
  Result<Scanner> take_ground_radio_scanner(std::size_t share);
  /// Returns the error for a device of this kind that could not be claimed: `text`, such as `needs a radio`.
  /// If another controller has claimed devices of the kind, the error names them.
  Error missing(std::string_view kind, std::string text) const;
  /// The devices that this object has claimed, in the order in which it has claimed them: indices into the
  /// argument `devices` of the constructor.
  const std::vector<std::size_t>& chosen() const { return chosen_; }

 private:
  static bool has_fan(const engine::DeviceInfo& device);
  Error no_scanner() const;

  std::span<const engine::DeviceInfo> devices_;
  std::vector<bool>& claimed_;
  std::vector<std::size_t> chosen_;
};

}  // namespace troupe::models
