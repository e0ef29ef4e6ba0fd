#pragma once

#include "base/pose.hpp"
#include "engine/description.hpp"

#include <cstdint>
#include <vector>

namespace troupe::engine {

// The parameters of sensors that readers and writers of Stage's worlds take apart, too.

/// A transducer of a ranger, as its parameters say.
struct TransducerParams {
  Pose pose;
  double range_min = 0;
  double range_max = 5;
  double fov = 0.1;
  std::int64_t samples = 1;
  double noise_stddev = 0;
  double noise_proportional = 0;
  double noise_angular = 0;
  bool apply_range_min = false;
  double beam_width = 0;
  double noise_relative = 0;

  static constexpr void describe(Description<TransducerParams>& d) {
    using namespace facts;
    using enum Unit;
    constexpr double k_most_m = 10000;
    d.member<&TransducerParams::pose>("pose", "of the transducer in the sensor's frame");
    d.member<&TransducerParams::range_min>("range_min", meters, at_least(0),
                                           "no effect unless apply_range_min is true");
    d.member<&TransducerParams::range_max>("range_max", meters, above(0), at_most(k_most_m),
                                           "length of the beams, and the reading if nothing is hit");
    d.member<&TransducerParams::fov>(
        "fov", radians, within(0, 2 * k_pi),
        "angle between the first and the last beam; a single sample always looks straight ahead");
    d.member<&TransducerParams::samples>("samples", within(1, 100000), counts_readings,
                                         "beams of the transducer");
    d.member<&TransducerParams::noise_stddev>(
        "noise_stddev", meters, within(0, k_most_m),
        "standard deviation of a normal error of each reading below range_max");
    d.member<&TransducerParams::noise_proportional>(
        "noise_proportional", within(0, 1), "largest uniform error of a reading, as a fraction of it");
    d.member<&TransducerParams::noise_angular>("noise_angular", radians, within(0, k_pi),
                                               "largest uniform error of the direction of each beam");
    d.member<&TransducerParams::apply_range_min>(
        "apply_range_min",
        "readings below range_min become range_min; if false, they are reported as they are");
    d.member<&TransducerParams::beam_width>(
        "beam_width", radians, within(0, k_pi),
        "opening angle of each beam, as of a sonar, which reads the nearest surface within it");
    d.member<&TransducerParams::noise_relative>(
        "noise_relative", within(0, 1),
        "standard deviation of a normal error of each reading below range_max, as a fraction of it");
  }

  /// Of beam i, from the transducer's heading, rad.
  double bearing(std::int64_t i) const {
    return samples == 1 ? 0.0 : -fov / 2 + static_cast<double>(i) * (fov / static_cast<double>(samples - 1));
  }
};

/// The parameters of a ranger.
struct RangerParams {
  std::vector<TransducerParams> transducers;
  bool intensity = false;

  static constexpr void describe(Description<RangerParams>& d) {
    using namespace facts;
    d.member<&RangerParams::transducers>("transducers", required,
                                         "fans of beams, each with a pose of its own");
    d.member<&RangerParams::intensity>("intensity", "also report the ranger_return of what each beam hits");
  }
};

/// A strip of a bumper, as its parameters say.
struct BumperStripParams {
  Pose pose;
  double length = 0;

  static constexpr void describe(Description<BumperStripParams>& d) {
    using namespace facts;
    using enum Unit;
    d.member<&BumperStripParams::pose>(
        "pose", "of the middle of the strip, which runs across its heading, in the sensor's frame");
    d.member<&BumperStripParams::length>("length", required, meters, above(0), at_most(1000),
                                         "from end to end");
  }
};

/// The parameters of a bumper.
struct BumperParams {
  std::vector<BumperStripParams> bumpers;
  double thickness = 0.02;

  static constexpr void describe(Description<BumperParams>& d) {
    using namespace facts;
    using enum Unit;
    d.member<&BumperParams::bumpers>("bumpers", required, "contact strips, each with a pose of its own");
    d.member<&BumperParams::thickness>("thickness", meters, within(0, 10),
                                       "distance from a strip within which a body touches it");
  }
};

}  // namespace troupe::engine
