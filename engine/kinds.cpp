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

}  // namespace troupe::engine
