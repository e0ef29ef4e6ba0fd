#include "models/controllers/device_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace troupe::models {

bool DeviceChoice::has_fan(const engine::DeviceInfo& device) {
  return std::ranges::any_of(device.prepared.transducers, [](const engine::Transducer& transducer) {
    return transducer.samples >= k_least_samples;
  });
}

Error DeviceChoice::no_scanner() const {
  std::string text = fmt::format(
      "needs a scanner: a ranger with at least {} beams in total, at least one of which points within 30 "
      "degrees of straight ahead",
      k_least_samples);
  bool has_ranger = false;
  for (std::size_t d = 0; d < devices_.size(); ++d) {
    const std::size_t beams = devices_[d].prepared.bearings.size();
    if (beams == 0) continue;
    has_ranger = true;
    const std::string_view why = claimed_[d]                ? "is read by another controller"
                                 : beams >= k_least_samples ? "has no beam ahead"
                                                            : "has too few beams";
    text += fmt::format("; \"{}\" ({} beams) {}", devices_[d].name, beams, why);
  }
  return {has_ranger ? text : text + "; the robot has no ranger"};
}

}  // namespace troupe::models
