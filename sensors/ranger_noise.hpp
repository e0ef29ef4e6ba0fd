#pragma once

#include "base/random.hpp"
#include "engine/kinds/kinds.hpp"
#include "sensors/ranger_beams.hpp"

#include <utility>
#include <vector>

namespace troupe::sensors {

/// Returns the random numbers for the headings of the beams of the i-th body of the batch (the bodies that
/// one task of a parallel loop handles). They come from another random stream than the noise of readings, so
/// that angular noise does not change the other noise.
Random random_of_headings(const engine::DeviceBatch& batch, std::size_t i);

/// Computes the directions of beams with angular noise. The object stores the results, so that calls of
/// draw() after the first ones allocate no memory.
class NoisyHeadings {
 public:
  /// Draws the directions of the beams of a group that has angular noise, for one body in one tick: each
  /// heading gets an error that is uniform within +- BeamGroup::angular_noise. Returns the x and the y
  /// components of the unit directions, body frame, one per beam and padded like the group's arrays. The
  /// pointers are valid until the next call.
  std::pair<const double*, const double*> draw(const BeamGroup& group, Random& random);

 private:
  std::vector<double> dx_, dy_;
};

/// Applies the noise of readings, the lower limits and the beam widths of transducers (RangerBeams::extras)
/// to the readings of a batch whose beams have been cast. A transducer is a fan of beams of a ranger (range
/// sensor). First, each reading of a beam with a width becomes the distance to the nearest surface within
/// this width. The width is centred on the heading along which the beam was cast, angular noise included.
/// Then noise is added, and last, readings below the lower limit are raised to the limit.
///
/// With noise, a reading r below range_max becomes r + r * noise_proportional * u + noise_stddev * n +
/// r * noise_relative * m, clamped to [0, range_max]; u is uniform in [-1, 1), and n and m are standard
/// normal. A reading of range_max means that nothing was hit, and gets no noise. (In Stage a reading with
/// noise may become negative or exceed range_max.)
void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
