#pragma once

#include "engine/kinds/registry.hpp"
#include "worldio/load.hpp"

#include <string>
#include <vector>

namespace troupe::worldio {

/// Returns kinds (implementations of sensors, drives and controllers) that only the tests of the loader use.
/// Changes of the real kinds therefore do not affect these tests. The kinds have parameters but no functions.
inline engine::Registry json_test_registry() {
  using engine::FieldType;
  using engine::Unit;
  static const engine::FieldTable transducer{{
      {.name = "pose", .type = FieldType::record, .text = "where it looks", .record = &engine::pose_fields()},
      {.name = "range_max",
       .unit = Unit::meters,
       .fallback = 5.0,
       .min = 0,
       .max = 100,
       .text = "reach",
       .above_min = true},
      {.name = "fov", .unit = Unit::radians, .fallback = 0.1, .min = 0, .max = 2 * k_pi, .text = "opening"},
      {.name = "samples", .type = FieldType::integer, .fallback = 1, .min = 1, .max = 1000, .text = "beams"},
  }};
  engine::Registry registry;
  engine::DeviceKind ranger{.name = "ranger", .text = "distances"};
  ranger.params = {
      {{.name = "transducers", .type = FieldType::records, .text = "fans of beams", .record = &transducer},
       {.name = "intensity", .type = FieldType::boolean, .fallback = false, .text = "brightness too"}}};
  registry.devices = {ranger};
  for (const std::string_view name : {"diff", "omni", "car"}) {
    engine::DriveKind drive{.name = name, .text = "moves"};
    drive.params = {
        {{.name = "speed_max", .unit = Unit::meters_per_second, .fallback = 1.0, .min = 0, .text = "limit"}}};
    registry.drives.push_back(drive);
  }
  registry.drives[2].params.fields.push_back(
      {.name = "wheelbase", .unit = Unit::meters, .min = 0, .text = "between the axles", .above_min = true});
  engine::ControllerKind expand{.name = "expand", .text = "disperses"};
  expand.params = {{{.name = "gain", .unit = Unit::per_second, .fallback = 1.0, .text = "turns"},
                    {.name = "clearances",
                     .type = FieldType::numbers,
                     .unit = Unit::meters,
                     .fallback = std::vector<double>{},
                     .min = 0,
                     .text = "by beam"},
                    {.name = "law",
                     .type = FieldType::text,
                     .fallback = "near",
                     .text = "which",
                     .choices = {"near", "far"}}}};
  registry.controllers = {expand};
  registry.presets = {{"expand_swarm", "expand", "with numbers", {{"gain", 2.5}}}};
  return registry;
}

/// Returns the messages of a load, one text per error, warning or other finding.
inline std::vector<std::string> findings(const Diagnostics& diagnostics) {
  std::vector<std::string> lines;
  for (const Finding& finding : diagnostics.findings()) lines.push_back(diagnostics.text(finding));
  return lines;
}

}  // namespace troupe::worldio
