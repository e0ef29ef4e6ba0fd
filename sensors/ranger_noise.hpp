#pragma once

#include "base/random.hpp"
#include "engine/kinds.hpp"
#include "sensors/ranger_beams.hpp"

#include <utility>
#include <vector>

namespace troupe::sensors {

/// Returns the random numbers for the headings of the beams of row i of the batch. They are a stream separate
/// from that for the noise of its readings.
Random random_of_headings(const engine::DeviceBatch& batch, std::size_t i);

/// Draws the directions of beams with angular noise, body frame.
class NoisyHeadings {
 public:
  /// Draws the directions for one row in one tick. Returns the x and the y components, one per beam, padded
  /// like the group's arrays. They are valid until the next draw.
  std::pair<const double*, const double*> draw(const BeamGroup& group, Random& random);

 private:
  std::vector<double> dx_, dy_;
};

/// Applies the extras of transducers to the readings of a batch whose beams have been cast, in this order:
/// the nearest surface within the width of each beam, noise, and the lower limit of readings.
///
/// A reading r below range_max becomes r + r * noise_proportional * u + noise_stddev * n + r * noise_relative
/// * m, with u uniform in [-1, 1), n and m standard normal, clamped to [0, range_max]. A reading of range_max
/// means that nothing was hit, and gets no noise. (In Stage a reading with noise may become negative or
/// exceed range_max.)
void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
