#include "sensors/ranger.hpp"

#include "engine/world.hpp"
#include "partition/ranging.hpp"
#include "sensors/ranger_beams.hpp"
#include "sensors/ranger_exact.hpp"
#include "sensors/ranger_grid.hpp"

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
       .text = "kept for the record; readings below it are reported as they are"},
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
       .text = "beams of the transducer"},
  }};
  return table;
}

constexpr std::size_t k_fan = 32;  // beams cast together at most, where they are no scan

/// Whether the second half of the beams looks in the opposite directions of the first.
bool mirrored(const RangerBeams& ranger, const BeamGroup& group) {
  constexpr double k_same = 1e-9;
  const std::size_t half = group.count / 2;
  bool same = ranger.common_origin && group.count % 2 == 0;
  for (std::size_t i = group.first; i < group.first + half; ++i)
    same = same && std::abs(ranger.dx[i] + ranger.dx[i + half]) < k_same &&
           std::abs(ranger.dy[i] + ranger.dy[i + half]) < k_same;
  return same;
}

/// Adds the beams of one transducer to the groups.
void group_beams(RangerBeams& ranger, std::size_t first, std::size_t count, const Pose& pose, double fov) {
  if (ranger.common_origin && count > k_fan) {
    const SinCos middle = sincos(pose.heading);
    ranger.groups.push_back({.first = first,
                             .count = count,
                             .z = pose.z,
                             .scan = true,
                             .middle = {middle.cos, middle.sin},
                             .fov = fov,
                             .step = fov / static_cast<double>(count - 1)});
    return;
  }
  for (std::size_t i = first; i < first + count; ++i) {
    const bool joins = !ranger.groups.empty() && !ranger.groups.back().scan &&
                       ranger.groups.back().z == pose.z && ranger.groups.back().count < k_fan;
    if (!joins) ranger.groups.push_back({.first = i, .z = pose.z});
    ++ranger.groups.back().count;
  }
}

engine::SensorKind::Prepared prepare(const engine::Record& params, const Pose& pose_body_sensor) {
  engine::SensorKind::Prepared out;
  RangerBeams ranger;
  ranger.intensity = params[1].boolean();
  std::vector<Pose> poses;  // of the transducers, body frame
  double farthest = 0;
  for (const engine::Record& transducer : params[0].records()) {
    const engine::Record& p = transducer[0].records().front();
    const Pose pose_sensor_transducer{p[0].number(), p[1].number(), p[2].number(), p[3].number()};
    const Pose pose = compose(pose_body_sensor, pose_sensor_transducer);
    const double range_max = transducer[2].number();
    const double fov = transducer[3].number();
    const auto samples = static_cast<std::size_t>(transducer[4].integer());
    out.transducers.push_back(out.bearings.size());
    out.transducer_headings.push_back(pose_sensor_transducer.heading);
    poses.push_back(pose);
    for (std::size_t i = 0; i < samples; ++i) {
      const double within =
          samples == 1 ? 0.0 : -fov / 2 + static_cast<double>(i) * (fov / static_cast<double>(samples - 1));
      out.bearings.push_back(pose_sensor_transducer.heading + within);
      const SinCos direction = sincos(pose.heading + within);
      ranger.dx.push_back(direction.cos);
      ranger.dy.push_back(direction.sin);
      ranger.ox.push_back(pose.x);
      ranger.oy.push_back(pose.y);
      ranger.range_max.push_back(static_cast<float>(range_max));
    }
    farthest = std::max(farthest, range_max);
  }
  ranger.reference = poses.empty() ? pose_body_sensor.position() : poses.front().position();
  for (const Pose& pose : poses)
    ranger.common_origin = ranger.common_origin && pose.position() == ranger.reference;
  if (!ranger.common_origin) ranger.reference = pose_body_sensor.position();
  for (std::size_t i = 0; i < ranger.dx.size(); ++i) {
    const Vec2 offset(ranger.ox[i] - ranger.reference.x(), ranger.oy[i] - ranger.reference.y());
    ranger.ox[i] = offset.x();
    ranger.oy[i] = offset.y();
    ranger.spread = std::max(ranger.spread, offset.norm());
  }
  ranger.reach = ranger.spread + farthest;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    const std::size_t end = t + 1 < poses.size() ? out.transducers[t + 1] : ranger.dx.size();
    group_beams(ranger, out.transducers[t], end - out.transducers[t], poses[t],
                params[0].records()[t][3].number());
  }
  for (BeamGroup& group : ranger.groups) group.mirrored = mirrored(ranger, group);

  out.beams = ranger.count = ranger.dx.size();
  for (std::vector<double>* array : {&ranger.dx, &ranger.dy, &ranger.ox, &ranger.oy})
    array->resize(array->size() + partition::k_beam_padding);
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

std::uint64_t sense(const engine::World& world, const std::any& data, std::span<const Row> rows,
                    engine::StateTable& percepts) {
  const RangerBeams& ranger = *std::any_cast<RangerBeams>(&data);
  if (world.ray_grid())
    cast_grid(world, ranger, rows, percepts);
  else
    cast_exact(world, ranger, rows, percepts);
  return rows.size() * ranger.count;
}

}  // namespace

engine::SensorKind ranger_kind() {
  engine::SensorKind kind{.name = "ranger",
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
