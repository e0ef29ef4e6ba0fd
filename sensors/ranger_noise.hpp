#pragma once

#include "base/random.hpp"
#include "engine/kinds.hpp"
#include "sensors/ranger_beams.hpp"

#include <utility>
#include <vector>

namespace troupe::sensors {

/// The random numbers that one row's beams take for their headings, apart from those of its readings.
Random random_of_headings(const engine::DeviceBatch& batch, std::size_t i);

/// Directions of beams that do not leave exactly where they should, body frame.
class Wobbling {
 public:
  /// Of one row in one tick: x and y, an entry a beam, repeating the last as the group's arrays do. Until the
  /// next draw.
  std::pair<const double*, const double*> draw(const BeamGroup& group, Random& random);

 private:
  std::vector<double> dx_, dy_;
};

/// What the transducers make of the readings of a batch that has been cast: the nearest surface within each
/// beam's width, noise, and the least reading.
///
/// A reading r below range_max becomes r + r * noise_proportional * u + noise_stddev * n, with u uniform in
/// [-1, 1) and n normal, and stays within 0 and range_max; one of range_max, which says that nothing was met,
/// stays as it is. (In Stage it may come out negative, or above range_max.)
void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
