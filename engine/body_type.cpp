#include "engine/body_type.hpp"

#include "engine/placement.hpp"
#include "engine/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::engine {
namespace {

template <class Kinds>
std::string unknown(std::string_view what, std::string_view name, const Kinds& kinds) {
  std::vector<std::string_view> names;
  for (const auto& kind : kinds) names.push_back(kind.name);
  return unknown_name(what, name, std::move(names));
}

void add_geometry(const TypeSpec& spec, BodyType& type) {
  double radius2 = 0;
  for (const PartSpec& part : spec.parts) {
    for (const Solid& solid : part.solids) {
      for (const Ring& ring : solid.contours) {
        for (const Vec2& v : ring) radius2 = std::max(radius2, v.squaredNorm());
        if (part.returns.ranger < 0) continue;
        type.outlines.push_back({static_cast<std::uint32_t>(type.outline_vertices.size()),
                                 static_cast<std::uint32_t>(ring.size()), solid.z, part.returns.ranger});
        type.outline_vertices.insert(type.outline_vertices.end(), ring.begin(), ring.end());
      }
    }
  }
  if (is_mobile(spec) || !spec.sensors.empty())
    type.obstacle = obstacle_shape(spec);  // others: the static scene
  type.radius = sqrt(radius2);
}

}  // namespace

BodyType make_body_type(const TypeSpec& spec, const Registry& registry, double tick_s,
                        Diagnostics& diagnostics) {
  BodyType type;
  type.name = spec.name;
  add_geometry(spec, type);

  constexpr double k_thin_m = 0.5e-3;
  if (spec.drive && !type.obstacle.empty() && type.obstacle.thinnest < k_thin_m) {
    diagnostics.warning(
        spec.parts.front().where,
        fmt::format("a part of type \"{}\" is only {:.3g} m thick: each of its motions is tested at "
                    "steps of a quarter of that, which is slow; make it {} m or more",
                    spec.name, type.obstacle.thinnest, k_thin_m));
  }
  if (spec.drive) {
    if (const DriveKind* kind = registry.drive(spec.drive->kind)) {
      if (const std::string fault = kind->fault(spec.drive->params); !fault.empty())
        diagnostics.error(spec.drive->where, fmt::format("drive \"{}\": {}", spec.drive->kind, fault));
      type.drive = {kind, kind->prepare(spec.drive->params), period_ticks(spec.drive->period_s, tick_s)};
    } else
      diagnostics.error(spec.drive->where, unknown("drive", spec.drive->kind, registry.drives));
  }

  for (const SensorSpec& sensor : spec.sensors) {
    const SensorKind* kind = registry.sensor(sensor.kind);
    if (!kind) {
      diagnostics.error(sensor.where, unknown("sensor", sensor.kind, registry.sensors));
      continue;
    }
    // Readings are found, and hashed, by name.
    std::string name = sensor.name;
    for (int n = 2; std::ranges::find(type.sensors, name, &BodyType::Sensor::name) != type.sensors.end(); ++n)
      name = fmt::format("{}#{}", sensor.name, n);
    if (name != sensor.name) {
      diagnostics.warning(
          sensor.where,
          fmt::format("a second sensor \"{}\" of one robot: it is called \"{}\"", sensor.name, name));
    }
    type.sensors.push_back({name, kind, kind->prepare(sensor.params, sensor.pose_body_sensor),
                            period_ticks(sensor.period_s, tick_s), sensor.active});
  }

  std::vector<SensorInfo> infos;
  for (const BodyType::Sensor& s : type.sensors) infos.push_back({s.name, s.kind->name, s.prepared});
  std::vector<bool> claimed(infos.size(), false);
  for (std::size_t c = 0; c < spec.controllers.size(); ++c) {
    const ControllerSpec& controller = spec.controllers[c];
    const ControllerKind* kind = registry.controller(controller.kind);
    if (!kind) {
      diagnostics.error(controller.where, unknown("controller", controller.kind, registry.controllers));
      continue;
    }
    if (!type.drive) {
      diagnostics.error(controller.where,
                        fmt::format("controller \"{}\" needs a body with a drive", controller.kind));
      continue;
    }
    std::string fault;
    ControllerKind::Prepared prepared = kind->prepare(controller.params, infos, claimed, fault);
    if (!fault.empty()) {
      diagnostics.error(controller.where, fmt::format("controller \"{}\" {}", controller.kind, fault));
      continue;
    }
    if (prepared.sensors.size() > k_most_sensors_read) {
      diagnostics.error(controller.where,
                        fmt::format("controller \"{}\" reads {} sensors; at most {} are possible",
                                    controller.kind, prepared.sensors.size(), k_most_sensors_read));
      continue;
    }
    for (const std::size_t s : prepared.sensors) type.sensors[s].active = true;
    const std::uint64_t period =
        prepared.sensors.empty() ? type.drive->period : type.sensors[prepared.sensors.front()].period;
    type.controllers.push_back({kind, std::move(prepared.data), std::move(prepared.sensors), period,
                                stream_id(kind->name, std::to_string(c)), std::nullopt});
  }
  return type;
}

}  // namespace troupe::engine
