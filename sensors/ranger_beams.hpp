#pragma once

#include "base/pose.hpp"
#include "engine/kinds/sensor_params.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace troupe::sensors {

/// A group of beams of a ranger (range sensor) that are cast together. All beams of a group have the same
/// height. Arrays have one entry per beam, in the order of the readings.
///
/// The arrays dx, dy, ox, oy, range_max and limits are padded, because the code that casts beams reads whole
/// SIMD vectors. Their size is partition::padded_beams(count), which is `count` rounded up to a multiple of
/// 16. The additional entries repeat the last beam.
struct BeamGroup {
  std::size_t first = 0;         ///< index of the first beam among the readings of the ranger
  std::size_t count = 0;         ///< number of beams
  double z = 0;                  ///< height, body frame, m
  std::vector<double> dx, dy;    ///< unit directions, body frame
  std::vector<double> ox, oy;    ///< origins relative to RangerBeams::reference, body frame, m
  std::vector<float> range_max;  ///< reading of a beam that hits nothing, m
  std::vector<float> limits;     ///< lengths of the beams: range_max plus margins for rounding errors, m
  float farthest = 0;            ///< the largest of the limits, m
  /// True if the beams of the second half are opposite to those of the first: for each i below count / 2, the
  /// beams i and i + count / 2 have opposite directions, within 1e-9. Always false if the number of beams is
  /// odd or if the group has angular noise.
  bool mirrored = false;
  /// True if the group is a scan. A scan contains all beams of one transducer (fan of beams), and these are
  /// more than partition::k_most_beams (32). The beams of a scan start at RangerBeams::reference, have equal
  /// angular steps, and have no angular noise. The members middle, fov and step are set only for a scan.
  bool scan = false;
  Vec2 middle = Vec2::UnitX();  ///< direction halfway between the first and the last beam, body frame
  double fov = 0;               ///< angle between the first and the last beam, rad
  double step = 0;              ///< angle between neighbouring beams, rad
  /// Headings of the beams without noise, body frame, rad. This array and angular_noise are empty if no beam
  /// of the group has angular noise.
  std::vector<double> headings;
  std::vector<double> angular_noise;  ///< bound of the uniformly distributed error of each heading, rad
};

/// One transducer (fan of beams) of a ranger. add_extras() (sensors/ranger_noise.hpp) applies its noise,
/// lower limit and beam width to its readings after its beams have been cast.
struct Transducer {
  engine::TransducerParams params;  ///< its parameters in the world file
  Pose pose;                        ///< pose of the beams at rest, body frame
  std::size_t first = 0;            ///< index of its first reading among the readings of the ranger
  /// Headings of the beams without noise, body frame, rad; empty if the beams have no width.
  std::vector<double> headings = {};

  std::size_t samples() const {
    return static_cast<std::size_t>(params.samples);
  }  ///< number of its readings
  /// The heading of beam i without noise, body frame, rad.
  double heading(std::size_t i) const { return pose.heading + params.bearing(static_cast<std::int64_t>(i)); }
  /// Lower readings are raised to this value, m; 0: none.
  double least() const { return params.apply_range_min ? params.range_min : 0; }
  bool has_noise() const {  ///< whether its readings have noise
    return params.noise_stddev > 0 || params.noise_relative > 0 || params.noise_proportional > 0;
  }
  bool has_extras() const { return has_noise() || least() > 0 || params.beam_width > 0; }
};

/// The beams of a ranger (range sensor), prepared once from its parameters. Both ray engines use them: the
/// exact engine, which intersects beams with outlines, and the grid engine, which follows rays through the
/// cells of a grid. In this file, the body frame is the frame of the body or joint that carries the ranger. A
/// transducer is a fan of beams of the ranger.
struct RangerBeams {
  std::size_t count = 0;           ///< number of beams of all transducers
  std::vector<BeamGroup> groups;   ///< all beams, in the order of the readings
  Vec2 reference = Vec2::Zero();   ///< origins of beams are relative to this point; body frame, m
  bool common_origin = true;       ///< whether all beams start at `reference`
  double spread = 0;               ///< distance from the reference to the farthest origin, m
  double reach = 0;                ///< bound on the distance from the reference to the end of any beam, m
  bool intensity = false;          ///< whether the readings contain intensities
  bool has_angular_noise = false;  ///< whether any beam has angular noise
  std::vector<Transducer> extras;  ///< the transducers for which Transducer::has_extras() is true
};

}  // namespace troupe::sensors
