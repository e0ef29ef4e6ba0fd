#include "sensors/compass.hpp"

#include "base/math.hpp"
#include "engine/world.hpp"

namespace troupe::sensors {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Element;
using engine::Record;
using engine::Unit;

struct Compass {
  double heading_body_sensor = 0;
  double noise_stddev = 0;
  double declination = 0;
};

/// In (-pi, pi]: wrap_angle() leaves -pi as it is.
double wrapped(double heading) {
  const double inside = wrap_angle(heading);
  return inside == -k_pi ? k_pi : inside + 0.0;  // never -0
}

std::uint64_t sense(const DeviceBatch& batch) {
  const Compass& compass = *std::any_cast<Compass>(&batch.data);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const double error = compass.noise_stddev > 0 ? compass.noise_stddev * batch.random(i).normal() : 0;
    batch.state.cell<double>(batch.slot(i), k_compass_heading)[0] =
        wrapped(batch.mount(i).heading + compass.heading_body_sensor + compass.declination + error);
  }
  return 0;
}

DeviceKind::Prepared prepare(const Record& params, const Pose& pose_body_sensor) {
  return {
      .data = Compass{pose_body_sensor.heading, params[0].number(), params[1].number()},
      .percepts = {{"heading", Element::f64, 1, "rad", "of its x axis in the world frame, in (-pi, pi]"}}};
}

}  // namespace

DeviceKind compass_kind() {
  DeviceKind kind{.name = "compass", .text = "reads its heading in the world frame"};
  kind.params = {{
      {.name = "noise_stddev",
       .unit = Unit::radians,
       .fallback = 0.0,
       .min = 0,
       .max = k_pi,
       .text = "standard deviation of a normal error of each reading"},
      {.name = "declination",
       .unit = Unit::radians,
       .fallback = 0.0,
       .min = -k_pi,
       .max = k_pi,
       .text = "constant error of each reading, counter-clockwise"},
  }};
  kind.prepare = prepare;
  kind.sense = sense;
  return kind;
}

}  // namespace troupe::sensors
