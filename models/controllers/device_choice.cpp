#include "models/controllers/device_choice.hpp"

#include "sensors/radio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace troupe::models {

Result<> DeviceChoice::take_radio(std::size_t bytes) {
  const bool has_radio = take([bytes](const engine::DeviceInfo& device) {
    return device.kind == "radio" && sensors::payload_of(device.prepared) >= bytes;
  });
  if (!has_radio)
    return missing("radio", fmt::format("needs a radio with a payload of {} bytes or more", bytes));
  return {};
}

Result<Scanner> DeviceChoice::take_scanner(std::size_t share) {
  Scanner scanner;
  const auto is_usable = [&](const engine::DeviceInfo& device) {
    scanner = Scanner(device, share);
    return scanner.is_usable();
  };
  const bool has_one =
      take([&](const engine::DeviceInfo& device) { return has_fan(device) && is_usable(device); }) ||
      take(is_usable);
  if (!has_one) return no_scanner();
  return scanner;
}

Result<Scanner> DeviceChoice::take_ground_radio_scanner(std::size_t share) {
  if (!take_kind("ground")) return missing("ground", "needs a ground sensor (a device of kind \"ground\")");
  if (!take_kind("radio")) return missing("radio", "needs a radio (a device of kind \"radio\")");
  return take_scanner(share);
}

Error DeviceChoice::missing(std::string_view kind, std::string text) const {
  for (std::size_t d = 0; d < devices_.size(); ++d)
    if (devices_[d].kind == kind && claimed_[d] && std::ranges::count(chosen_, d) == 0)
      text += fmt::format("; \"{}\" is used by another controller", devices_[d].name);
  return {std::move(text)};
}

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
    text += fmt::format("; \"{}\" ({} beam{}) {}", devices_[d].name, beams, beams == 1 ? "" : "s", why);
  }
  return {has_ranger ? text : text + "; the robot has no ranger"};
}

}  // namespace troupe::models
