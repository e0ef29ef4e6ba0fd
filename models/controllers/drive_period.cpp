#include "models/controllers/drive_period.hpp"

#include "engine/spec/ticks.hpp"
#include "models/drives/wheels.hpp"

namespace troupe::models {

std::uint64_t drive_period(const engine::WorldSpec& world, const engine::TypeSpec& type, std::uint32_t part) {
  for (;; part = type.parts[part].parent) {
    for (const engine::DeviceSpec& device : type.devices)
      if (device.part == part && device.kind == wheels_kind().name)
        return engine::period_ticks(device.period_s, world.tick_s);
    if (part == 0) return type.drive ? engine::period_ticks(type.drive->period_s, world.tick_s) : 1;
  }
}

}  // namespace troupe::models
