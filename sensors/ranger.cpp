#include "sensors/ranger.hpp"

#include "engine/kinds/device_kind.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "partition/ranging.hpp"
#include "sensors/ranger_beams.hpp"
#include "sensors/ranger_exact.hpp"
#include "sensors/ranger_grid.hpp"
#include "sensors/ranger_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe::sensors {
namespace {

using engine::TransducerParams;

/// Whether the number of beams is even and, for each beam i of the first half, beam i + count / 2 has the
/// opposite direction.
bool mirrored(const BeamGroup& group) {
  constexpr double k_same = 1e-9;
  const std::size_t half = group.count / 2;
  bool same = group.count % 2 == 0;
  for (std::size_t i = 0; i < half; ++i)
    same = same && std::abs(group.dx[i] + group.dx[i + half]) < k_same &&
           std::abs(group.dy[i] + group.dy[i + half]) < k_same;
  return same;
}

/// One transducer of a ranger, and its pose.
struct Transducer {
  const TransducerParams& params;
  Pose pose;  // body frame

  std::size_t samples() const { return static_cast<std::size_t>(params.samples); }
  /// The heading of beam i, body frame, rad.
  double heading(std::size_t i) const { return pose.heading + params.bearing(static_cast<std::int64_t>(i)); }
};

void add_beam(BeamGroup& group, const Transducer& transducer, std::size_t i, const Vec2& reference) {
  const SinCos direction = sincos(transducer.heading(i));
  group.dx.push_back(direction.cos);
  group.dy.push_back(direction.sin);
  group.ox.push_back(transducer.pose.x - reference.x());
  group.oy.push_back(transducer.pose.y - reference.y());
  group.range_max.push_back(static_cast<float>(transducer.params.range_max));
  group.headings.push_back(transducer.heading(i));
  group.angular_noise.push_back(transducer.params.noise_angular);
  ++group.count;
}

/// Adds the beams of one transducer to the groups. A transducer with more than k_most_beams beams becomes a
/// group of its own (a scan), if all transducers start at one point and the beams of the transducer have no
/// angular noise. Other beams are added to the last group if this group has the same height and is not full,
/// and else to a new group.
void group_beams(RangerBeams& ranger, const Transducer& transducer) {
  const TransducerParams& params = transducer.params;
  const bool scan =
      ranger.common_origin && transducer.samples() > partition::k_most_beams && params.noise_angular == 0;
  for (std::size_t i = 0; i < transducer.samples(); ++i) {
    const BeamGroup* last = ranger.groups.empty() ? nullptr : &ranger.groups.back();
    const bool joins = scan ? i > 0
                            : last != nullptr && !last->scan && last->z == transducer.pose.z &&
                                  last->count < partition::k_most_beams;
    if (!joins) {
      ranger.groups.push_back({.first = ranger.count, .z = transducer.pose.z, .scan = scan});
      if (scan) {
        BeamGroup& group = ranger.groups.back();
        const SinCos middle = sincos(transducer.pose.heading);
        group.middle = {middle.cos, middle.sin};
        group.fov = params.fov;
        group.step = params.fov / static_cast<double>(params.samples - 1);
      }
    }
    add_beam(ranger.groups.back(), transducer, i, ranger.reference);
    ++ranger.count;
  }
}

/// Adds the extras of a transducer to the ranger if the transducer has noise of readings, a range_min that is
/// applied, or a beam width. first: the column of the transducer's first reading.
void add_extras_of(const Transducer& transducer, std::size_t first, RangerBeams& ranger) {
  const TransducerParams& params = transducer.params;
  TransducerExtras extras{.first = first,
                          .count = transducer.samples(),
                          .range_max = params.range_max,
                          .noise_stddev = params.noise_stddev,
                          .noise_relative = params.noise_relative,
                          .noise_proportional = params.noise_proportional,
                          .least = params.apply_range_min ? params.range_min : 0,
                          .noise_angular = params.noise_angular,
                          .beam_width = params.beam_width,
                          .origin = transducer.pose.position(),
                          .z = transducer.pose.z};
  ranger.has_angular_noise = ranger.has_angular_noise || params.noise_angular > 0;
  if (extras.beam_width > 0)
    for (std::size_t i = 0; i < transducer.samples(); ++i) extras.headings.push_back(transducer.heading(i));
  if (extras.noise_stddev > 0 || extras.noise_relative > 0 || extras.noise_proportional > 0 ||
      extras.least > 0 || extras.beam_width > 0)
    ranger.extras.push_back(std::move(extras));
}

/// Completes a group after its last beam has been added: computes whether it is mirrored, pads the arrays,
/// and computes the limits. These data do not change between casts.
void finish(BeamGroup& group) {
  if (std::ranges::all_of(group.angular_noise, [](double noise) { return noise == 0; })) {
    group.headings.clear();
    group.angular_noise.clear();
  }
  group.mirrored = group.angular_noise.empty() && mirrored(group);
  const std::size_t padded = partition::padded_beams(group.count);
  for (std::vector<double>* array : {&group.dx, &group.dy, &group.ox, &group.oy})
    array->resize(padded, array->back());
  group.range_max.resize(padded, group.range_max.back());
  group.limits.resize(padded);
  const std::vector<float> nothing_met(padded);
  group.farthest = partition::limits_of({.count = group.count}, nothing_met.data(), group.range_max.data(),
                                        group.limits.data());
}

/// Checks the lower limits of readings. Without apply_range_min they have no effect, and may have any value.
Result<> check_limits(const std::vector<TransducerParams>& transducers) {
  for (std::size_t i = 0; i < transducers.size(); ++i)
    if (const TransducerParams& one = transducers[i]; one.apply_range_min && one.range_min > one.range_max)
      return Error{fmt::format(
          "has a range_min of {:g} m in transducer {} (counted from 0), which must be at most its range_max "
          "of {:g} m, because apply_range_min is true",
          one.range_min, i, one.range_max)};
  return {};
}

}  // namespace

engine::DeviceKind::Prepared Ranger::prepare(const Params& params, const Pose& pose_body_sensor) {
  engine::DeviceKind::Prepared out;
  RangerBeams beams;
  beams.intensity = params.intensity;
  std::vector<Transducer> transducers;
  double farthest = 0;
  for (const TransducerParams& one : params.transducers) {
    const Transducer transducer{one, compose(pose_body_sensor, one.pose)};
    add_extras_of(transducer, out.bearings.size(), beams);
    out.transducers.push_back({.first = out.bearings.size(),
                               .samples = transducer.samples(),
                               .pose_sensor_transducer = one.pose,
                               .range_max = one.range_max,
                               .fov = one.fov});
    for (std::int64_t i = 0; i < one.samples; ++i) out.bearings.push_back(one.pose.heading + one.bearing(i));
    farthest = std::max(farthest, one.range_max);
    transducers.push_back(transducer);
  }
  beams.reference = transducers.empty() ? pose_body_sensor.position() : transducers.front().pose.position();
  for (const Transducer& transducer : transducers)
    beams.common_origin = beams.common_origin && transducer.pose.position() == beams.reference;
  if (!beams.common_origin) beams.reference = pose_body_sensor.position();
  for (const Transducer& transducer : transducers) {
    beams.spread = std::max(beams.spread, (transducer.pose.position() - beams.reference).norm());
    group_beams(beams, transducer);
  }
  beams.reach = beams.spread + farthest;
  for (BeamGroup& group : beams.groups) finish(group);

  constexpr double k_watts = 0.2;  // per transducer, as in Stage
  out.watts = k_watts * static_cast<double>(transducers.size());
  out.beams = beams.count;
  out.reach_m = beams.reference.norm() + beams.reach;
  const auto columns = static_cast<std::uint32_t>(out.beams);
  out.percepts.push_back(
      {"ranges", engine::Element::f32, columns, "m", "distance to the first surface along each beam"});
  if (beams.intensity)
    out.percepts.push_back({"intensities", engine::Element::f32, columns, "",
                            "ranger_return of the surface that each beam hits"});
  out.data = Ranger{std::make_shared<const RangerBeams>(std::move(beams)), check_limits(params.transducers)};
  return out;
}

std::uint64_t Ranger::sense(const engine::DeviceBatch& batch) const {
  if (batch.view.ray_grid())
    cast_grid(batch, *beams);
  else
    cast_exact(batch, *beams);
  if (!beams->extras.empty()) add_extras(batch, *beams);
  return batch.rows.size() * beams->count;
}

engine::DeviceKind ranger_kind() {
  return engine::make_device_kind<Ranger>(
      "ranger", "reads the distance along each beam to the first surface (sonar, infrared, laser)");
}

}  // namespace troupe::sensors
