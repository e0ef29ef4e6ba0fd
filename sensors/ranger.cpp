#include "sensors/ranger.hpp"

#include "engine/world.hpp"
#include "partition/ranging.hpp"
#include "sensors/ranger_beams.hpp"
#include "sensors/ranger_exact.hpp"
#include "sensors/ranger_grid.hpp"
#include "sensors/ranger_noise.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::sensors {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Unit;

const FieldTable& transducer_fields() {
  static const FieldTable table{{
      {.name = "pose",
       .type = FieldType::record,
       .text = "of the transducer in the sensor's frame",
       .record = &engine::pose_fields()},
      {.name = "range_min",
       .unit = Unit::meters,
       .fallback = 0.0,
       .min = 0,
       .text = "kept for the record unless apply_range_min"},
      {.name = "range_max",
       .unit = Unit::meters,
       .fallback = 5.0,
       .min = 0,
       .max = 10000,
       .text = "length of the beams, and the reading where nothing is met",
       .above_min = true},
      {.name = "fov",
       .unit = Unit::radians,
       .fallback = 0.1,
       .min = 0,
       .max = 2 * k_pi,
       .text = "angle between the first and the last beam; one sample looks straight ahead whatever it is"},
      {.name = "samples",
       .type = FieldType::integer,
       .fallback = 1,
       .min = 1,
       .max = 100000,
       .text = "beams of the transducer",
       .counts_readings = true},
      {.name = "noise_stddev",
       .unit = Unit::meters,
       .fallback = 0.0,
       .min = 0,
       .max = 10000,
       .text = "standard deviation of a normal error of each reading of what is met"},
      {.name = "noise_proportional",
       .fallback = 0.0,
       .min = 0,
       .max = 1,
       .text = "share of a reading by which it is off at most, uniformly"},
      {.name = "noise_angular",
       .unit = Unit::radians,
       .fallback = 0.0,
       .min = 0,
       .max = k_pi,
       .text = "angle by which each beam is off at most, uniformly"},
      {.name = "apply_range_min",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "readings below range_min are range_min; else they are reported as they are"},
      {.name = "beam_width",
       .unit = Unit::radians,
       .fallback = 0.0,
       .min = 0,
       .max = k_pi,
       .text = "opening angle of each beam, as a sonar has: the nearest surface anywhere in it is read"},
      {.name = "noise_relative",
       .fallback = 0.0,
       .min = 0,
       .max = 1,
       .text = "standard deviation of a normal error of each reading of what is met, as a share of it"},
  }};
  return table;
}

/// Whether the second half of the beams looks in the opposite directions of the first.
bool mirrored(const BeamGroup& group) {
  constexpr double k_same = 1e-9;
  const std::size_t half = group.count / 2;
  bool same = group.count % 2 == 0;
  for (std::size_t i = 0; i < half; ++i)
    same = same && std::abs(group.dx[i] + group.dx[i + half]) < k_same &&
           std::abs(group.dy[i] + group.dy[i + half]) < k_same;
  return same;
}

/// One transducer as its parameters say.
struct Transducer {
  Pose pose;  // body frame
  double range_max;
  double fov;
  std::size_t samples;
  double noise_angular;

  /// Of beam i, from the transducer's heading, rad.
  double bearing(std::size_t i) const {
    return samples == 1 ? 0.0 : -fov / 2 + static_cast<double>(i) * (fov / static_cast<double>(samples - 1));
  }
};

void add_beam(BeamGroup& group, const Transducer& transducer, std::size_t i, const Vec2& reference) {
  const SinCos direction = sincos(transducer.pose.heading + transducer.bearing(i));
  group.dx.push_back(direction.cos);
  group.dy.push_back(direction.sin);
  group.ox.push_back(transducer.pose.x - reference.x());
  group.oy.push_back(transducer.pose.y - reference.y());
  group.range_max.push_back(static_cast<float>(transducer.range_max));
  group.headings.push_back(transducer.pose.heading + transducer.bearing(i));
  group.wobbles.push_back(transducer.noise_angular);
  ++group.count;
}

/// Adds the beams of one transducer to the groups.
void group_beams(RangerBeams& ranger, const Transducer& transducer) {
  const bool scan =
      ranger.common_origin && transducer.samples > partition::k_most_beams && transducer.noise_angular == 0;
  for (std::size_t i = 0; i < transducer.samples; ++i) {
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
        group.fov = transducer.fov;
        group.step = transducer.fov / static_cast<double>(transducer.samples - 1);
      }
    }
    add_beam(ranger.groups.back(), transducer, i, ranger.reference);
    ++ranger.count;
  }
}

/// What the transducer does beside casting beams, if anything; `first` is the column of its first reading.
void add_extras_of(const engine::Record& record, const Transducer& transducer, std::size_t first,
                   RangerBeams& ranger) {
  TransducerExtras extras{.first = first,
                          .count = transducer.samples,
                          .range_max = transducer.range_max,
                          .noise_stddev = record[5].number(),
                          .noise_relative = record[10].number(),
                          .noise_proportional = record[6].number(),
                          .least = record[8].boolean() ? record[1].number() : 0,
                          .beam_width = record[9].number(),
                          .origin = transducer.pose.position(),
                          .z = transducer.pose.z};
  ranger.wobbles = ranger.wobbles || transducer.noise_angular > 0;
  if (extras.beam_width > 0)
    for (std::size_t i = 0; i < transducer.samples; ++i)
      extras.headings.push_back(transducer.pose.heading + transducer.bearing(i));
  if (extras.noise_stddev > 0 || extras.noise_relative > 0 || extras.noise_proportional > 0 ||
      extras.least > 0 || extras.beam_width > 0)
    ranger.extras.push_back(std::move(extras));
}

/// What is the same in every cast.
void finish(BeamGroup& group) {
  if (std::ranges::all_of(group.wobbles, [](double wobble) { return wobble == 0; })) {
    group.headings.clear();
    group.wobbles.clear();
  }
  group.mirrored = group.wobbles.empty() && mirrored(group);
  const std::size_t padded = partition::padded_beams(group.count);
  for (std::vector<double>* array : {&group.dx, &group.dy, &group.ox, &group.oy})
    array->resize(padded, array->back());
  group.range_max.resize(padded, group.range_max.back());
  group.limits.resize(padded);
  const std::vector<float> nothing_met(padded);
  group.farthest = partition::limits_of({.count = group.count}, nothing_met.data(), group.range_max.data(),
                                        group.limits.data());
}

engine::DeviceKind::Prepared prepare(const engine::Record& params, const Pose& pose_body_sensor) {
  engine::DeviceKind::Prepared out;
  RangerBeams ranger;
  ranger.intensity = params[1].boolean();
  std::vector<Transducer> transducers;
  double farthest = 0;
  for (const engine::Record& record : params[0].records()) {
    const engine::Record& p = record[0].records().front();
    const Pose pose_sensor_transducer{p[0].number(), p[1].number(), p[2].number(), p[3].number()};
    const Transducer transducer{compose(pose_body_sensor, pose_sensor_transducer), record[2].number(),
                                record[3].number(), static_cast<std::size_t>(record[4].integer()),
                                record[7].number()};
    add_extras_of(record, transducer, out.bearings.size(), ranger);
    out.transducers.push_back({.first = out.bearings.size(),
                               .samples = transducer.samples,
                               .pose_sensor_transducer = pose_sensor_transducer,
                               .range_max = transducer.range_max,
                               .fov = transducer.fov});
    for (std::size_t i = 0; i < transducer.samples; ++i)
      out.bearings.push_back(pose_sensor_transducer.heading + transducer.bearing(i));
    farthest = std::max(farthest, transducer.range_max);
    transducers.push_back(transducer);
  }
  ranger.reference = transducers.empty() ? pose_body_sensor.position() : transducers.front().pose.position();
  for (const Transducer& transducer : transducers)
    ranger.common_origin = ranger.common_origin && transducer.pose.position() == ranger.reference;
  if (!ranger.common_origin) ranger.reference = pose_body_sensor.position();
  for (const Transducer& transducer : transducers) {
    ranger.spread = std::max(ranger.spread, (transducer.pose.position() - ranger.reference).norm());
    group_beams(ranger, transducer);
  }
  ranger.reach = ranger.spread + farthest;
  for (BeamGroup& group : ranger.groups) finish(group);

  constexpr double k_watts = 0.2;  // a transducer, as in Stage
  out.watts = k_watts * static_cast<double>(transducers.size());
  out.beams = ranger.count;
  out.reach_m = ranger.reference.norm() + ranger.reach;
  const auto columns = static_cast<std::uint32_t>(out.beams);
  out.percepts.push_back(
      {"ranges", engine::Element::f32, columns, "m", "distance to the first surface, a beam each"});
  if (ranger.intensity)
    out.percepts.push_back(
        {"intensities", engine::Element::f32, columns, "", "ranger_return of what was met"});
  out.data = std::move(ranger);
  return out;
}

std::uint64_t sense(const engine::DeviceBatch& batch) {
  const RangerBeams& ranger = *std::any_cast<RangerBeams>(&batch.data);
  if (batch.world.ray_grid())
    cast_grid(batch, ranger);
  else
    cast_exact(batch, ranger);
  if (!ranger.extras.empty()) add_extras(batch, ranger);
  return batch.rows.size() * ranger.count;
}

}  // namespace

engine::DeviceKind ranger_kind() {
  engine::DeviceKind kind{.name = "ranger",
                          .text = "distances along beams to the first surface (sonar, infrared, laser)"};
  kind.params = {{
      {.name = "transducers",
       .type = FieldType::records,
       .text = "fans of beams, each with a pose of its own",
       .record = &transducer_fields()},
      {.name = "intensity",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "also report the ranger_return of what each beam met"},
  }};
  kind.prepare = prepare;
  kind.sense = sense;
  return kind;
}

}  // namespace troupe::sensors
