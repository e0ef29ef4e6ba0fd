#pragma once

#include "engine/kinds.hpp"
#include "models/scan_ahead.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::models {

/// What a controller takes of a body's devices, one after another, in its `choose`.
class DeviceChoice {
 public:
  /// Both must outlive it; `claimed` has an entry a device.
  DeviceChoice(std::span<const engine::DeviceInfo> devices, std::vector<bool>& claimed)
      : devices_(devices), claimed_(claimed) {}

  /// Claims the first device that nobody has and that fits; false where there is none.
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
  /// Claims the first of this kind that nobody has; false where there is none.
  bool take_kind(std::string_view kind) {
    return take([kind](const engine::DeviceInfo& device) { return device.kind == kind; });
  }
  /// A ranger whose first transducer has at least k_least_samples samples; how many those are, 0 where there
  /// is none.
  std::size_t take_scanner() {
    std::size_t samples = 0;
    const bool has_one = take([&](const engine::DeviceInfo& device) {
      const auto& layout = device.prepared;
      if (layout.transducers.empty()) return false;
      samples = layout.transducers.size() > 1 ? layout.transducers[1] : layout.bearings.size();
      return samples >= k_least_samples;
    });
    return has_one ? samples : 0;
  }
  /// A ground sensor, a radio and a scanner, as `take_scanner` has it, in this order: how many samples that
  /// has. Where one of them is missing 0, and `fault` says which.
  std::size_t take_ground_radio_scanner(std::string& fault) {
    if (!take_kind("ground")) {
      fault = "needs a ground sensor";
      return 0;
    }
    if (!take_kind("radio")) {
      fault = "needs a radio";
      return 0;
    }
    const std::size_t samples = take_scanner();
    if (samples == 0) {
      fault = "needs a scanner: a ranger whose first transducer has more than ";
      fault += std::to_string(k_least_samples - 1);
      fault += " samples";
    }
    return samples;
  }
  /// Indices of what was taken, in this order.
  const std::vector<std::size_t>& chosen() const { return chosen_; }

 private:
  std::span<const engine::DeviceInfo> devices_;
  std::vector<bool>& claimed_;
  std::vector<std::size_t> chosen_;
};

}  // namespace troupe::models
