#include "sensors/ranger_noise.hpp"

#include "engine/sensing/sensing_view.hpp"
#include "sensors/ranger_cone.hpp"

#include <algorithm>

namespace troupe::sensors {
namespace {

/// Draws the headings of the beams of a group that has angular noise, body frame, rad. Calls visit(index of
/// the beam in the group, heading) for each.
template <class Visit>
void draw_headings(const BeamGroup& group, Random& random, Visit&& visit) {
  for (std::size_t i = 0; i < group.count; ++i)
    visit(i, group.headings[i] + group.angular_noise[i] * random.uniform(-1, 1));
}

/// Sets, for each beam of the ranger that has angular noise, the entry of its reading in `headings` to the
/// heading, body frame, rad, along which the beam was cast for the i-th body of the batch.
void draw_headings_again(const engine::DeviceBatch& batch, std::size_t i, const RangerBeams& ranger,
                         std::vector<double>& headings) {
  Random random = random_of_headings(batch, i);
  headings.resize(std::max(headings.size(), ranger.count));
  for (const BeamGroup& group : ranger.groups)
    if (!group.angular_noise.empty())
      draw_headings(group, random,
                    [&](std::size_t beam, double heading) { headings[group.first + beam] = heading; });
}

void add_noise(const engine::TransducerParams& params, Random& random, std::span<float> ranges) {
  const auto range_max = static_cast<float>(params.range_max);
  for (float& range : ranges) {
    // The numbers are drawn even if the beam hits nothing, so that the numbers for the next beams do not
    // depend on whether this beam hits something.
    const double share = params.noise_proportional > 0 ? random.uniform(-1, 1) : 0;
    const double normal = params.noise_stddev > 0 ? random.normal() : 0;
    const double relative = params.noise_relative > 0 ? random.normal() : 0;
    if (range >= range_max) continue;
    const double noisy = range + range * params.noise_proportional * share + params.noise_stddev * normal +
                         range * params.noise_relative * relative;
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
  draw_headings(group, random, [&](std::size_t i, double heading) {
    const SinCos direction = sincos(heading);
    dx_[i] = direction.cos;
    dy_[i] = direction.sin;
  });
  for (std::size_t i = group.count; i < group.dx.size(); ++i) {
    dx_[i] = dx_[i - 1];
    dy_[i] = dy_[i - 1];
  }
  return {dx_.data(), dy_.data()};
}

void add_extras(const engine::DeviceBatch& batch, const RangerBeams& ranger) {
  thread_local std::vector<double> noisy_headings;  // by reading
  const auto has_noisy_width = [](const Transducer& transducer) {
    return transducer.params.beam_width > 0 && transducer.params.noise_angular > 0;
  };
  const bool draws_again = std::ranges::any_of(ranger.extras, has_noisy_width);
  const auto headings_of = [&](const Transducer& transducer) {
    const std::span<const double> all(has_noisy_width(transducer) ? noisy_headings : transducer.headings);
    return has_noisy_width(transducer) ? all.subspan(transducer.first, transducer.samples()) : all;
  };
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    Random random = batch.random(i);
    if (draws_again) draw_headings_again(batch, i, ranger, noisy_headings);
    const std::span<float> ranges = batch.state.cell<float>(batch.slot(i), 0);
    const std::span<float> intensities =
        ranger.intensity ? batch.state.cell<float>(batch.slot(i), 1) : std::span<float>();
    for (const Transducer& transducer : ranger.extras) {
      const std::span<float> own = ranges.subspan(transducer.first, transducer.samples());
      if (transducer.params.beam_width > 0)
        cast_cones(
            batch.view, batch.rows[i], batch.mount(i), transducer, headings_of(transducer), own,
            ranger.intensity ? intensities.subspan(transducer.first, transducer.samples()) : intensities);
      if (transducer.has_noise()) add_noise(transducer.params, random, own);
      for (float& range : own) range = std::max(range, static_cast<float>(transducer.least()));
    }
  }
}

}  // namespace troupe::sensors
