#pragma once

#include "base/pose.hpp"
#include "engine/fields/description.hpp"

#include <cstdint>
#include <vector>

namespace troupe::engine {

// Parameters of those sensors whose parameter structs the reader and the writer of world files of the
// simulator Stage also use. The function `describe` of each struct gives the meaning, unit and limits of its
// members.

/// Parameters of a transducer of a ranger (range sensor). A transducer is a fan of beams that start at one
/// place.
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
    d.member<&TransducerParams::pose>("pose", "pose of the transducer in the sensor's frame");
    d.member<&TransducerParams::range_min>(
        "range_min", meters, at_least(0), used_if("apply_range_min", "true"),
        "lower limit of readings; it has an effect only if apply_range_min is true");
    d.member<&TransducerParams::range_max>(
        "range_max", meters, above(0), at_most(k_most_m),
        "length of the beams, and the reading of a beam that meets nothing");
    d.member<&TransducerParams::fov>(
        "fov", radians, within(0, 2 * k_pi), used_unless("samples", "1"),
        "angle between the first and the last beam; a single beam always points straight ahead");
    d.member<&TransducerParams::samples>("samples", within(1, 100000), counts_readings, "number of beams");
    d.member<&TransducerParams::noise_stddev>(
        "noise_stddev", meters, within(0, k_most_m),
        "standard deviation of the normally distributed error of each reading below range_max");
    d.member<&TransducerParams::noise_proportional>(
        "noise_proportional", within(0, 1),
        "bound on the uniformly distributed error of each reading below range_max, as a fraction of the "
        "reading");
    d.member<&TransducerParams::noise_angular>(
        "noise_angular", radians, within(0, k_pi),
        "bound on the uniformly distributed angular error of each beam");
    d.member<&TransducerParams::apply_range_min>("apply_range_min",
                                                 "true: readings below range_min are raised to range_min");
    d.member<&TransducerParams::beam_width>("beam_width", radians, within(0, k_pi),
                                            "opening angle of each beam, as in a sonar: the reading is the "
                                            "distance to the nearest surface within "
                                            "this angle");
    d.member<&TransducerParams::noise_relative>(
        "noise_relative", within(0, 1),
        "standard deviation of the normally distributed error of each reading below range_max, as a fraction "
        "of the reading");
  }

  /// Angle of beam i from the transducer's heading, rad, counter-clockwise; i is below `samples`. A single
  /// beam has the angle 0.
  double bearing(std::int64_t i) const {
    return samples == 1 ? 0.0 : -fov / 2 + static_cast<double>(i) * (fov / static_cast<double>(samples - 1));
  }
};

/// The parameters of a ranger (range sensor).
struct RangerParams {
  std::vector<TransducerParams> transducers;
  bool intensity = false;

  static constexpr void describe(Description<RangerParams>& d) {
    using namespace facts;
    d.member<&RangerParams::transducers>("transducers", required, "fans of beams, each with its own pose");
    d.member<&RangerParams::intensity>(
        "intensity",
        "true: each beam also reports an intensity, the ranger_return of the surface that it hits");
  }
};

/// Parameters of one contact strip of a bumper (contact sensor).
struct BumperStripParams {
  Pose pose;
  double length = 0;

  static constexpr void describe(Description<BumperStripParams>& d) {
    using namespace facts;
    using enum Unit;
    d.member<&BumperStripParams::pose>(
        "pose",
        "pose of the strip's centre in the sensor's frame; the strip is perpendicular to the heading");
    d.member<&BumperStripParams::length>("length", required, meters, above(0), at_most(1000),
                                         "length of the strip");
  }
};

/// The parameters of a bumper (contact sensor), which has one or more contact strips.
struct BumperParams {
  std::vector<BumperStripParams> bumpers;
  double thickness = 0.02;
  /// False, as in Stage, unless a JSON world says otherwise: worlds that were stored before had no crashes.
  bool crashes = false;

  static constexpr void describe(Description<BumperParams>& d) {
    using namespace facts;
    using enum Unit;
    d.member<&BumperParams::bumpers>("bumpers", required, "contact strips, each with its own pose");
    d.member<&BumperParams::thickness>("thickness", meters, within(0, 10),
                                       "distance up to which a strip detects bodies");
    d.member<&BumperParams::crashes>(
        "crashes", in_json(1), is_sparse,
        "true: a strip also detects a body if a motion that was blocked since the last reading, of the robot "
        "or of that body, would have brought them together; a blocked robot stops short of what it hits, by "
        "up to the way of a tick");
  }
};

}  // namespace troupe::engine
