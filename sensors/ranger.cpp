#include "sensors/ranger.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "partition/ranging.hpp"
#include "sensors/heights.hpp"
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

bool is_in(const ConvexPrism& piece, const Vec2& point) {
  for (std::size_t i = 0; i < piece.outline.size(); ++i) {
    const Vec2& a = piece.outline[i];
    const Vec2& b = piece.outline[(i + 1) % piece.outline.size()];
    if (cross(b - a, point - a) < 0) return false;
  }
  return true;
}

/// Whether all beams of a ranger end inside `body`, the outline of the robot that carries the ranger. Such
/// beams detect only bodies that overlap the robot.
bool stays_inside(const RangerBeams& ranger, const partition::ObstacleShape& body) {
  const auto stays = [&](const BeamGroup& group, std::size_t beam) {
    const Vec2 from = ranger.reference + Vec2(group.ox[beam], group.oy[beam]);
    const Vec2 to = from + group.range_max[beam] * Vec2(group.dx[beam], group.dy[beam]);
    return std::ranges::any_of(body.pieces, [&](const ConvexPrism& piece) {
      return piece.z.contains(group.z) && is_in(piece, from) && is_in(piece, to);
    });
  };
  return std::ranges::all_of(ranger.groups, [&](const BeamGroup& group) {
    for (std::size_t beam = 0; beam < group.count; ++beam)
      if (!stays(group, beam)) return false;
    return true;
  });
}

/// The outlines that rangers see.
struct VisibleOutlines {
  Heights heights;
  std::vector<std::uint32_t>
      lifting;  // types of bodies with an outline that a joint, such as a lift, may raise

  explicit VisibleOutlines(const engine::LintWorld& world) {
    for (std::uint32_t t = 0; t < world.types.size(); ++t) {
      bool lifts = false;
      for (const engine::RayOutline& outline : world.types[t].outlines) {
        for (const auto& [z, count] : world.levels[t]) heights.add(outline.z.shifted(z), count);
        lifts = lifts || outline.joint != engine::k_rigid;
      }
      if (lifts && world.bodies[t] > 0) lifting.push_back(t);
    }
    heights.sum();
  }
};

}  // namespace

engine::DeviceKind::Prepared Ranger::prepare(const Params& params, const Pose& pose_body_sensor) {
  engine::DeviceKind::Prepared out;
  RangerBeams beams;
  beams.intensity = params.intensity;
  std::vector<Transducer> transducers;
  double farthest = 0;
  for (const TransducerParams& one : params.transducers) {
    Transducer transducer{
        .params = one, .pose = compose(pose_body_sensor, one.pose), .first = out.bearings.size()};
    out.transducers.push_back({.first = transducer.first,
                               .samples = transducer.samples(),
                               .pose_sensor_transducer = one.pose,
                               .range_max = one.range_max,
                               .fov = one.fov});
    for (std::int64_t i = 0; i < one.samples; ++i) out.bearings.push_back(one.pose.heading + one.bearing(i));
    if (one.beam_width > 0)
      for (std::size_t i = 0; i < transducer.samples(); ++i)
        transducer.headings.push_back(transducer.heading(i));
    beams.has_angular_noise = beams.has_angular_noise || one.noise_angular > 0;
    if (transducer.has_extras()) beams.extras.push_back(transducer);
    farthest = std::max(farthest, one.range_max);
    transducers.push_back(std::move(transducer));
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

void Ranger::lint(const engine::LintView& view) const {
  const engine::BodyType::Device& device = view.device();
  const std::string beginning = engine::sees_nothing_text(device.name, view.body_type().name);
  if (beams->count == 0) return view.warn(engine::LintTopic::sight, beginning + "it has no beams");
  if (device.joint != engine::k_rigid || view.is_set({"transducers"})) return;
  if (stays_inside(*beams, view.body_type().obstacle)) {
    float longest = 0;
    for (const BeamGroup& group : beams->groups)
      longest = std::max(longest, *std::ranges::max_element(group.range_max));
    return view.warn(
        engine::LintTopic::sight,
        beginning + fmt::format("its beams of at most {:.4g} m end inside its own body", longest));
  }
  const VisibleOutlines& visible = view.world.shared<VisibleOutlines>();
  if (view.has_other_of(visible.lifting)) return;
  std::vector<ZInterval> own;
  for (const engine::RayOutline& outline : view.body_type().outlines) own.push_back(outline.z);
  std::vector<double> heights;
  for (const BeamGroup& group : beams->groups) heights.push_back(group.z);
  if (const std::string why = why_at_no_height(view,
                                               {.all = visible.heights,
                                                .own = own,
                                                .none = "no other body that rangers see",
                                                .name = "bodies that rangers see"},
                                               heights);
      !why.empty())
    view.warn(engine::LintTopic::sight, beginning + why);
}

engine::DeviceKind ranger_kind() {
  return engine::make_device_kind<Ranger>(
      "ranger", "reads the distance along each beam to the first surface (sonar, infrared, laser)");
}

}  // namespace troupe::sensors
