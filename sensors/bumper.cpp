#include "sensors/bumper.hpp"

#include "engine/sight.hpp"

#include <algorithm>

namespace troupe::sensors {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Element;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;

/// One strip, from its right end to its left, body frame, m.
struct Strip {
  Vec2 right, left;
};

struct Bumper {
  std::vector<Strip> strips;
  double thickness = 0;
};

double distance(const Vec2& point, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - a - t * along).norm();
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto differ = [](double x, double y) { return (x < 0 && y > 0) || (x > 0 && y < 0); };
  return differ(cross(b - a, c - a), cross(b - a, d - a)) && differ(cross(d - c, a - c), cross(d - c, b - c));
}

/// Between two straight lines; 0 where they cross.
double distance(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  if (cross_each_other(a, b, c, d)) return 0;
  return std::min({distance(a, c, d), distance(b, c, d), distance(c, a, b), distance(d, a, b)});
}

/// The body that a strip, in the world's frame, feels; not valid: none.
BodyId felt(const engine::World& world, Row own, const Strip& strip, double thickness) {
  Box box;
  box.extend(strip.right);
  box.extend(strip.left);
  BodyId nearest;
  double least = thickness;
  const auto any = [](const partition::BodyCircle&) { return true; };
  const auto touch = [&](const engine::OutlineChain& chain) {
    engine::for_each_edge(chain, [&](const Vec2& a, const Vec2& b) {
      const double away = distance(strip.right, strip.left, a, b);
      if (away > least || (away == least && nearest < chain.body)) return;
      least = away;
      nearest = chain.body;
    });
  };
  engine::for_each_fixed_chain(world, box.expanded(thickness), any, touch);
  engine::for_each_body_chain(world, box.expanded(thickness), own, any, touch);
  return nearest;
}

std::uint64_t sense(const DeviceBatch& batch) {
  const Bumper& bumper = *std::any_cast<Bumper>(&batch.data);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const Row row = batch.rows[i];
    const Transform transform = batch.mount(i).transform;
    const auto hits = batch.state.cell<std::uint8_t>(batch.slot(i), k_bumper_hit);
    const auto bodies = batch.state.cell<std::uint32_t>(batch.slot(i), k_bumper_body);
    for (std::size_t k = 0; k < bumper.strips.size(); ++k) {
      const Strip there{transform * bumper.strips[k].right, transform * bumper.strips[k].left};
      const BodyId body = felt(batch.world, row, there, bumper.thickness);
      hits[k] = body.valid();
      bodies[k] = body.valid() ? body.value : 0;
    }
  }
  return 0;
}

DeviceKind::Prepared prepare(const Record& params, const Pose& pose_body_sensor) {
  Bumper bumper{.thickness = params[1].number()};
  double reach = 0;
  for (const Record& record : params[0].records()) {
    const Record& p = record[0].records().front();
    const Pose pose = compose(pose_body_sensor, {p[0].number(), p[1].number(), p[2].number(), p[3].number()});
    const double length = record[1].number();
    const Vec2 half = length / 2 * (Rotation(pose.heading) * Vec2::UnitY());
    bumper.strips.push_back({pose.position() - half, pose.position() + half});
    reach = std::max(reach, pose.position().norm() + length / 2);
  }
  const auto n = static_cast<std::uint32_t>(bumper.strips.size());
  return {.data = std::move(bumper),
          .percepts = {{"hit", Element::u8, n, "", "1: something touches that bumper"},
                       {"body", Element::u32, n, "", "id of the body that does; 0: none"}},
          .reach_m = reach + params[1].number(),
          .watts = 0.1};  // as in Stage
}

const FieldTable& strip_fields() {
  static const FieldTable table{{
      {.name = "pose",
       .type = FieldType::record,
       .text = "of the middle of the strip, which runs across its heading, in the sensor's frame",
       .record = &engine::pose_fields()},
      {.name = "length",
       .unit = Unit::meters,
       .min = 0,
       .max = 1000,
       .text = "from end to end",
       .above_min = true},
  }};
  return table;
}

}  // namespace

DeviceKind bumper_kind() {
  DeviceKind kind{.name = "bumper", .text = "feels what touches its strips"};
  kind.params = {{
      {.name = "bumpers",
       .type = FieldType::records,
       .text = "contact strips, each with a pose of its own",
       .record = &strip_fields()},
      {.name = "thickness",
       .unit = Unit::meters,
       .fallback = 0.02,
       .min = 0,
       .max = 10,
       .text = "how near to a strip a body is felt"},
  }};
  kind.prepare = prepare;
  kind.sense = sense;
  return kind;
}

}  // namespace troupe::sensors
