#pragma once

#include "base/random.hpp"
#include "engine/kinds/device_batch.hpp"
#include "sensors/ranger_beams.hpp"

#include <utility>
#include <vector>

namespace troupe::sensors {

/// Returns the random numbers for the angular noise of the ranger of the i-th body of the batch, that is, for
/// the errors of the headings of its beams. A batch is the bodies that one task of a parallel loop handles.
/// Angular noise has a random stream of its own. It therefore does not change the random numbers of the noise
/// that add_extras() adds to the readings.
Random random_of_headings(const engine::DeviceBatch& batch, std::size_t i);

/// Computes the directions of beams with angular noise. The object keeps its arrays: draw() allocates memory
/// only until the arrays are large enough.
class NoisyHeadings {
 public:
  /// Draws the directions in which the beams of a group are cast, for one body in one tick (time step). The
  /// group must have angular noise. The error of each heading is uniform from -angular_noise to
  /// +angular_noise (BeamGroup::angular_noise). Returns two arrays: the x components and the y components of
  /// the unit directions, body frame. They have one entry per beam and are padded to the size of group.dx.
  /// They are valid until the next call.
  std::pair<const double*, const double*> draw(const BeamGroup& group, Random& random);

 private:
  std::vector<double> dx_, dy_;
};

/// Applies the beam widths, the noise of readings and the lower limits of transducers to the readings of a
/// batch. A transducer is a fan of beams of a ranger (range sensor). A batch is the bodies that one task of a
/// parallel loop handles. The beams must have been cast before. For each transducer in RangerBeams::extras,
/// the function makes these steps, in this order:
///
/// width  If the beams have a width, each reading is lowered to the distance of the nearest surface within
///        this width. The middle of the width is the heading along which the beam was cast, with its angular
///        noise.
/// noise  Each reading r below range_max becomes
///          r + r * noise_proportional * u + noise_stddev * n + r * noise_relative * m,
///        clamped to [0, range_max]. The random numbers u, n and m are drawn for each reading; u is uniform
///        in [-1, 1), and n and m are standard normal. A reading of range_max means that the beam hit
///        nothing, and gets no noise.
/// limit  Readings below the lower limit are raised to this limit.
///
/// In Stage, unlike here, a reading with noise may become negative or exceed range_max.
void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
