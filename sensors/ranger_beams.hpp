#pragma once

#include "base/pose.hpp"

#include <cstddef>
#include <vector>

namespace troupe::sensors {

/// Beams of one height that are cast together. Each array has an entry a beam, and repeats the last up to
/// whole vectors.
struct BeamGroup {
  std::size_t first = 0;  ///< column of the first beam in the readings
  std::size_t count = 0;
  double z = 0;                ///< body frame, m
  std::vector<double> dx, dy;  ///< direction, body frame
  std::vector<double> ox, oy;  ///< origin less the ranger's reference, body frame, m
  std::vector<float> range_max;
  std::vector<float> limits;  ///< limits_of() beams that have met nothing yet
  float farthest = 0;         ///< of those limits
  bool mirrored = false;  ///< the second half looks in the opposite directions of the first, in their order
  bool scan = false;      ///< many beams at equal angles from the reference; the three below are theirs
  Vec2 middle = Vec2::UnitX();  ///< direction halfway between the first and the last, body frame
  double fov = 0;               ///< between the first and the last, rad
  double step = 0;              ///< between neighbours, rad
  /// Of beams that do not leave exactly where they should: none, or one each.
  std::vector<double> headings;  ///< body frame, rad
  std::vector<double> wobbles;   ///< the heading's error is uniform within plus and minus this, rad
};

/// What becomes of the readings of one transducer that does more than cast beams.
struct TransducerExtras {
  std::size_t first = 0;  ///< column of its first reading
  std::size_t count = 0;
  double range_max = 0;
  double noise_stddev = 0;        ///< of what is added to a reading, m
  double noise_proportional = 0;  ///< a reading's error is uniform within plus and minus this share of it
  double least = 0;               ///< m: lower readings are this
  double beam_width = 0;          ///< above 0: opening angle of each beam, rad
  Vec2 origin = Vec2::Zero();     ///< body frame, m
  double z = 0;                   ///< body frame, m
  std::vector<double> headings;   ///< of the beams where they have a width, body frame, rad
};

/// A ranger's beams, made once from its parameters: what both ray engines cast.
struct RangerBeams {
  std::size_t count = 0;
  std::vector<BeamGroup> groups;
  Vec2 reference = Vec2::Zero();  ///< body frame, m: what positions are taken relative to
  bool common_origin = true;      ///< all beams start at the reference
  double spread = 0;              ///< from the reference to the farthest origin, m
  double reach = 0;               ///< from the reference to the farthest point of any beam, m
  bool intensity = false;
  bool wobbles = false;                  ///< some beams do not leave exactly where they should
  std::vector<TransducerExtras> extras;  ///< of the transducers that need them
};

}  // namespace troupe::sensors
