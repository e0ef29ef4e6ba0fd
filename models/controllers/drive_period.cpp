#include "models/controllers/drive_period.hpp"

#include "engine/spec/ticks.hpp"
#include "models/drives/wheels.hpp"

namespace troupe::models {

const engine::DeviceSpec* wheels_of(const engine::TypeSpec& type, std::uint32_t part) {
  for (;; part = type.parts[part].parent) {
    for (const engine::DeviceSpec& device : type.devices)
      if (device.part == part && device.kind == wheels_kind().name) return &device;
    if (part == 0) return nullptr;
  }
}

std::uint64_t drive_period(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
  if (const engine::DeviceSpec* wheels = wheels_of(type, part))
    return engine::period_ticks(wheels->period_s, world.tick_s);
  return type.drive ? engine::period_ticks(type.drive->period_s, world.tick_s) : 1;
}

}  // namespace troupe::models
