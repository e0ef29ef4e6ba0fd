#pragma once

#include "base/random.hpp"
#include "engine/kinds.hpp"
#include "sensors/ranger_beams.hpp"

#include <utility>
#include <vector>

namespace troupe::sensors {

/// The random numbers for the headings of one row's beams, a stream separate from that of its readings.
Random random_of_headings(const engine::DeviceBatch& batch, std::size_t i);

/// Draws the directions of beams with angular noise, body frame.
class NoisyHeadings {
 public:
  /// Draws the directions for one row in one tick: x and y per beam, padded like the group's arrays. Valid
  /// until the next draw.
  std::pair<const double*, const double*> draw(const BeamGroup& group, Random& random);

 private:
  std::vector<double> dx_, dy_;
};

/// Applies the extras of transducers to the readings of a batch that has been cast: the nearest surface
/// within the width of each beam, noise, and the least reading.
///
/// A reading r below range_max becomes r + r * noise_proportional * u + noise_stddev * n + r * noise_relative
/// * m, with u uniform in [-1, 1), n and m standard normal, clamped to [0, range_max]. A reading of
/// range_max, which means that nothing was hit, stays as it is. (In Stage it may become negative, or exceed
/// range_max.)
void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
