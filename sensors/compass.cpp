#include "sensors/compass.hpp"

#include "base/math.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/sensing/sensing_view.hpp"

namespace troupe::sensors {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;

/// Wraps an angle (rad) into (-pi, pi]. wrap_angle() alone leaves -pi unchanged.
double wrapped(double heading) {
  const double inside = wrap_angle(heading);
  return inside == -k_pi ? k_pi : inside + 0.0;  // never -0
}

struct Compass {
  struct Params {
    double noise_stddev = 0;
    double declination = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::noise_stddev>("noise_stddev", radians, within(0, k_pi),
                                      "standard deviation of the normally distributed error of each reading");
      d.member<&Params::declination>("declination", radians, within(-k_pi, k_pi),
                                     "constant error of each reading, positive counter-clockwise");
    }
  };
  struct State {
    double heading = 0;

    static constexpr void describe(engine::Description<State>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&State::heading>("heading", radians,
                                "heading of the compass in the world frame, in (-pi, pi]");
    }
  };

  Params params;
  double heading_body_sensor = 0;

  static Compass make(const Params& params, const Pose& pose_body_sensor) {
    return {params, pose_body_sensor.heading};
  }

  std::uint64_t sense(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const double error = params.noise_stddev > 0 ? params.noise_stddev * batch.random(i).normal() : 0;
      batch.state.as<State>(batch.slot(i)).heading =
          wrapped(batch.mount(i).heading + heading_body_sensor + params.declination + error);
    }
    return 0;
  }
};

}  // namespace

DeviceKind compass_kind() {
  return engine::make_device_kind<Compass>("compass", "reads the heading of the sensor in the world frame");
}

}  // namespace troupe::sensors
