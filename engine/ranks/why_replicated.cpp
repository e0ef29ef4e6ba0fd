#include "engine/ranks/halo.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace troupe::engine {

std::string why_replicated(const World& world) {
  const WorldSpec& spec = world.spec();
  if (spec.ranging == RangingEngine::grid) return "the world uses the grid ray engine";
  for (std::size_t t = 0; t < spec.types.size(); ++t) {
    const BodyType& type = world.view().types()[t];
    const auto of_type = [&](std::string_view what) {
      return fmt::format("robots of type \"{}\" {}", spec.types[t].name, what);
    };
    if (type.pushable && type.is_composite())
      return of_type("can be pushed, and have joints or can carry bodies");
    for (const BodyType::Controller& controller : type.controllers)
      if (controller.kind->is_collective)
        return of_type(fmt::format("have the controller \"{}\", which decides for all robots in one call",
                                   controller.kind->name));
    for (const BodyType::Device& device : type.devices) {
      const DeviceKind& kind = *device.kind;
      if (kind.drives && !kind.joints.empty())
        return of_type(
            fmt::format("have the device \"{}\" of the kind \"{}\", which can drive a part of the robot "
                        "to any distance",
                        device.name, kind.name));
      if (kind.apply != nullptr && kind.scope == ApplyScope::anything)
        return of_type(fmt::format("have the device \"{}\" of the kind \"{}\", which can change any bodies",
                                   device.name, kind.name));
      if (!std::isfinite(device.prepared.reach_m))
        return of_type(fmt::format("have the device \"{}\" of the kind \"{}\", whose reach has no limit",
                                   device.name, kind.name));
    }
  }
  for (const ReserveSpec& reserve : spec.reserves)
    if (const TypeId type = spec.bodies[reserve.first.index()].type; !spec.types[type.index()].joints.empty())
      return fmt::format("robots of type \"{}\", which have joints, can be born",
                         spec.types[type.index()].name);
  if (!std::isfinite(world.interventions().settings().longest_reach()))
    return "an intervention changes the reach of a device to one that has no limit";
  return {};
}

}  // namespace troupe::engine
