#include "models/controllers/device_choice.hpp"

#include <fmt/format.h>

namespace troupe::models {

bool DeviceChoice::has_fan(const engine::DeviceInfo& device) {
  const std::vector<std::size_t>& first = device.prepared.transducers;
  for (std::size_t t = 0; t < first.size(); ++t) {
    const std::size_t end = t + 1 < first.size() ? first[t + 1] : device.prepared.bearings.size();
    if (end - first[t] >= k_least_samples) return true;
  }
  return false;
}

std::string DeviceChoice::scanner_fault() const {
  std::string fault = fmt::format(
      "needs a scanner: a ranger with {} or more beams, in one transducer or several, one of them within 30 "
      "degrees of straight ahead",
      k_least_samples);
  bool has_ranger = false;
  for (std::size_t d = 0; d < devices_.size(); ++d) {
    const std::size_t beams = devices_[d].prepared.bearings.size();
    if (beams == 0) continue;
    has_ranger = true;
    const std::string_view why = claimed_[d]                ? "is read by another controller"
                                 : beams >= k_least_samples ? "looks elsewhere"
                                                            : "has too few";
    fault += fmt::format("; \"{}\" ({}) {}", devices_[d].name, beams, why);
  }
  return has_ranger ? fault : fault + "; the robot has no ranger";
}

}  // namespace troupe::models
