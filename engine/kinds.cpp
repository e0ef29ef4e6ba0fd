#include "engine/kinds.hpp"

#include <algorithm>

namespace troupe::engine {
namespace {

template <class Kind>
const Kind* find(const std::vector<Kind>& kinds, std::string_view name) {
  const auto it = std::ranges::find(kinds, name, &Kind::name);
  return it == kinds.end() ? nullptr : &*it;
}

}  // namespace

const ModelKind* Registry::model(std::string_view name) const { return find(models, name); }
const DeviceKind* Registry::device(std::string_view name) const { return find(devices, name); }
const DriveKind* Registry::drive(std::string_view name) const { return find(drives, name); }
const ControllerKind* Registry::controller(std::string_view name) const { return find(controllers, name); }
const Registry::Preset* Registry::preset(std::string_view name) const { return find(presets, name); }
const MeasureKind* Registry::measure(std::string_view name) const { return find(measures, name); }

std::vector<DeviceKind> Registry::sensors() const {
  std::vector<DeviceKind> kinds = devices;
  std::erase_if(kinds, [](const DeviceKind& kind) { return !kind.is_sensor(); });
  return kinds;
}

std::vector<DeviceKind> Registry::other_devices() const {
  std::vector<DeviceKind> kinds = devices;
  std::erase_if(kinds, [](const DeviceKind& kind) { return kind.is_sensor(); });
  return kinds;
}

}  // namespace troupe::engine
