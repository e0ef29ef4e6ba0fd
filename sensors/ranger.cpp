#include "sensors/ranger.hpp"

namespace troupe::sensors {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Unit;

const FieldTable& transducer_fields() {
  static const FieldTable table{{
      {.name = "pose",
       .type = FieldType::record,
       .text = "of the transducer in the sensor's frame",
       .record = &engine::pose_fields()},
      {.name = "range_min",
       .unit = Unit::meters,
       .fallback = 0.0,
       .min = 0,
       .text = "kept for the record; readings below it are reported as they are"},
      {.name = "range_max",
       .unit = Unit::meters,
       .fallback = 5.0,
       .min = 0,
       .max = 10000,
       .text = "length of the beams, and the reading where nothing is met",
       .above_min = true},
      {.name = "fov",
       .unit = Unit::radians,
       .fallback = 0.1,
       .min = 0,
       .max = 2 * k_pi,
       .text = "angle between the first and the last beam; one sample looks straight ahead whatever it is"},
      {.name = "samples",
       .type = FieldType::integer,
       .fallback = 1,
       .min = 1,
       .max = 100000,
       .text = "beams of the transducer"},
  }};
  return table;
}

}  // namespace

engine::SensorKind ranger_kind() {
  engine::SensorKind kind{.name = "ranger", .text = "distances along beams to the first surface (sonar, infrared, laser)"};
  kind.params = {{
      {.name = "transducers",
       .type = FieldType::records,
       .text = "fans of beams, each with a pose of its own",
       .record = &transducer_fields()},
      {.name = "intensity",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "also report the ranger_return of what each beam met"},
  }};
  return kind;
}

}  // namespace troupe::sensors
