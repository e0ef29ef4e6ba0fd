#include "sensors/ranger_noise.hpp"

#include "engine/sensing/sensing_view.hpp"
#include "sensors/ranger_cone.hpp"

#include <algorithm>

namespace troupe::sensors {
namespace {

void add_noise(const TransducerExtras& extras, Random& random, std::span<float> ranges) {
  const auto range_max = static_cast<float>(extras.range_max);
  for (float& range : ranges) {
    // The numbers are drawn even if the beam hits nothing, so that the numbers for the next beams do not
    // depend on whether this beam hits something.
    const double share = extras.noise_proportional > 0 ? random.uniform(-1, 1) : 0;
    const double normal = extras.noise_stddev > 0 ? random.normal() : 0;
    const double relative = extras.noise_relative > 0 ? random.normal() : 0;
    if (range >= range_max) continue;
    const double noisy = range + range * extras.noise_proportional * share + extras.noise_stddev * normal +
                         range * extras.noise_relative * relative;
    range = std::clamp(static_cast<float>(noisy), 0.0f, range_max);
  }
}

}  // namespace

Random random_of_headings(const engine::DeviceBatch& batch, std::size_t i) {
  const auto stream = static_cast<std::uint32_t>(scramble(batch.stream));
  return {batch.view.spec().seed, stream, batch.body(i).value, static_cast<std::uint32_t>(batch.view.tick())};
}

std::pair<const double*, const double*> NoisyHeadings::draw(const BeamGroup& group, Random& random) {
  dx_.resize(std::max(dx_.size(), group.dx.size()));
  dy_.resize(std::max(dy_.size(), group.dy.size()));
  for (std::size_t i = 0; i < group.dx.size(); ++i) {
    if (i < group.count) {
      const SinCos direction = sincos(group.headings[i] + group.angular_noise[i] * random.uniform(-1, 1));
      dx_[i] = direction.cos;
      dy_[i] = direction.sin;
    } else {
      dx_[i] = dx_[i - 1];
      dy_[i] = dy_[i - 1];
    }
  }
  return {dx_.data(), dy_.data()};
}

void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger) {
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    Random random = batch.random(i);
    const std::span<float> ranges = batch.state.cell<float>(batch.slot(i), 0);
    const std::span<float> intensities =
        ranger.intensity ? batch.state.cell<float>(batch.slot(i), 1) : std::span<float>();
    for (const TransducerExtras& extras : ranger.extras) {
      const std::span<float> own = ranges.subspan(extras.first, extras.count);
      if (extras.beam_width > 0)
        cast_cones(batch.view, batch.rows[i], batch.mount(i), extras, own,
                   ranger.intensity ? intensities.subspan(extras.first, extras.count) : intensities);
      if (extras.noise_proportional > 0 || extras.noise_stddev > 0 || extras.noise_relative > 0)
        add_noise(extras, random, own);
      for (float& range : own) range = std::max(range, static_cast<float>(extras.least));
    }
  }
}

}  // namespace troupe::sensors
