#pragma once

#include "base/pose.hpp"

#include <cstddef>
#include <vector>

namespace troupe::sensors {

/// Beams at one height that are cast together. Arrays have one entry per beam. The arrays of directions,
/// origins, ranges and limits are padded to a multiple of the vector length by repeating the last beam.
struct BeamGroup {
  std::size_t first = 0;  ///< column of the first beam in the readings
  std::size_t count = 0;
  double z = 0;                ///< height, body frame, m
  std::vector<double> dx, dy;  ///< directions, body frame
  std::vector<double> ox, oy;  ///< origins relative to the ranger's reference, body frame, m
  std::vector<float> range_max;
  std::vector<float> limits;    ///< what limits_of() gives for beams that have hit nothing yet, m
  float farthest = 0;           ///< the largest of the limits, m
  bool mirrored = false;        ///< beam i + count / 2 has the opposite direction of beam i
  bool scan = false;            ///< equal angular steps from the reference; then the next three are set
  Vec2 middle = Vec2::UnitX();  ///< direction halfway between the first and the last beam, body frame
  double fov = 0;               ///< angle between the first and the last beam, rad
  double step = 0;              ///< angle between neighbouring beams, rad
  /// The next two are only for beams with angular noise: each is empty, or has one entry per beam.
  std::vector<double> headings;       ///< body frame, rad
  std::vector<double> angular_noise;  ///< the error of the heading is uniform within plus and minus this, rad
};

/// Noise, range_min and beam width of a transducer. They are applied to its readings after the beams have
/// been cast.
struct TransducerExtras {
  std::size_t first = 0;  ///< column of its first reading
  std::size_t count = 0;
  double range_max = 0;
  double noise_stddev = 0;        ///< standard deviation of the error of a reading, m
  double noise_relative = 0;      ///< standard deviation of the error of a reading, as a fraction of it
  double noise_proportional = 0;  ///< the error is uniform within plus and minus this fraction of the reading
  double least = 0;               ///< lower readings are raised to this value, m
  double beam_width = 0;          ///< if above 0: opening angle of each beam, rad
  Vec2 origin = Vec2::Zero();     ///< where its beams start, body frame, m
  double z = 0;                   ///< height of its beams, body frame, m
  std::vector<double> headings;   ///< headings of the beams if they have a width, body frame, rad
};

/// The beams of a ranger, prepared once from its parameters, for both ray engines.
struct RangerBeams {
  std::size_t count = 0;
  std::vector<BeamGroup> groups;
  Vec2 reference = Vec2::Zero();  ///< origins of beams are relative to this point; body frame, m
  bool common_origin = true;      ///< all beams start at the reference
  double spread = 0;              ///< distance from the reference to the farthest origin, m
  double reach = 0;               ///< bound on the distance from the reference to the end of any beam, m
  bool intensity = false;
  bool has_angular_noise = false;        ///< some beams have angular noise
  std::vector<TransducerExtras> extras;  ///< for the transducers that need them
};

}  // namespace troupe::sensors
