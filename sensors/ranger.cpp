#include "sensors/ranger.hpp"

#include "engine/world.hpp"
#include "partition/ranging.hpp"
#include "sensors/ranger_beams.hpp"

#include <array>
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

constexpr std::size_t k_fan = 256;  // beams cast together at most: their working set stays in the first cache
constexpr std::size_t k_edges = 128;  // edges gathered before they are projected

engine::SensorKind::Prepared prepare(const engine::Record& params, const Pose& pose_body_sensor) {
  engine::SensorKind::Prepared out;
  RangerBeams ranger;
  ranger.intensity = params[1].boolean();
  std::vector<Vec2> origins;
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
    for (std::size_t i = 0; i < samples; ++i) {
      const double within =
          samples == 1 ? 0.0 : -fov / 2 + static_cast<double>(i) * (fov / static_cast<double>(samples - 1));
      out.bearings.push_back(pose_sensor_transducer.heading + within);
      const SinCos direction = sincos(pose.heading + within);
      ranger.dx.push_back(direction.cos);
      ranger.dy.push_back(direction.sin);
      ranger.range_max.push_back(static_cast<float>(range_max));
      origins.push_back(pose.position());
      if (ranger.groups.empty() || ranger.groups.back().z != pose.z || ranger.groups.back().count == k_fan)
        ranger.groups.push_back({origins.size() - 1, 0, pose.z});
      ++ranger.groups.back().count;
    }
    farthest = std::max(farthest, range_max);
  }
  ranger.reference = origins.empty() ? pose_body_sensor.position() : origins.front();
  for (const Vec2& o : origins) ranger.common_origin = ranger.common_origin && o == ranger.reference;
  if (!ranger.common_origin) ranger.reference = pose_body_sensor.position();
  for (const Vec2& o : origins) {
    ranger.ox.push_back(o.x() - ranger.reference.x());
    ranger.oy.push_back(o.y() - ranger.reference.y());
    ranger.spread = std::max(ranger.spread, (o - ranger.reference).norm());
  }
  ranger.reach = ranger.spread + farthest;

  out.beams = origins.size();
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

/// Collects edges and projects them on a fan, a block at a time.
class Projector {
 public:
  Projector(const partition::Fan& fan, const Vec2& reference, std::span<float> inverse,
            std::span<float> returns)
      : fan_(fan), reference_(reference), inverse_(inverse), returns_(returns) {}

  void add(const Vec2& a, const Vec2& b, float ranger_return) {
    edges_[count_] = partition::relative_edge(a, b, reference_, ranger_return);
    if (++count_ == edges_.size()) flush();
  }
  void flush() {
    const std::span<const partition::RayEdge> edges(edges_.data(), count_);
    if (returns_.empty())
      partition::project(edges, fan_, inverse_);
    else
      partition::project(edges, fan_, inverse_, returns_);
    count_ = 0;
  }

 private:
  const partition::Fan& fan_;
  Vec2 reference_;
  std::span<float> inverse_;
  std::span<float> returns_;
  std::array<partition::RayEdge, k_edges> edges_;
  std::size_t count_ = 0;
};

/// Smallest squared distance from a point to the box of an edge: never more than to the edge.
double box_distance2(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 gap = (a.cwiseMin(b) - p).cwiseMax(p - a.cwiseMax(b)).cwiseMax(0.0);
  return gap.squaredNorm();
}

/// Collects the bodies in reach and projects those that some beam may meet, a block at a time, near ones
/// first.
class NearBodies {
 public:
  NearBodies(const engine::World& world, Row self, const Vec2& reference, double z, const partition::Fan& fan,
             std::span<const float> inverse, Projector& projector)
      : world_(world),
        self_(self),
        reference_(reference),
        z_(z),
        fan_(fan),
        inverse_(inverse),
        projector_(projector) {}

  /// Projects the bodies that reach within `to` of the reference and not within `from`.
  void project_between(double from, double to) {
    world_.index().for_each_near(Box::around(reference_, to),
                                 [&](const partition::BodyCircle& body) { add(body.row, from, to); });
    flush();
  }

 private:
  void add(std::uint32_t row, double from, double to) {
    const double radius = world_.type(Row(row)).radius;
    const Vec2 offset = world_.poses()[row].position() - reference_;
    const double apart = to + radius;
    const double done = from + radius;
    const double distance2 = offset.squaredNorm();
    if (row == self_.value || distance2 > apart * apart || (from > 0 && distance2 <= done * done)) return;
    const auto ring = static_cast<std::size_t>(distance2 / (apart * apart) * (k_rings - 1));
    near_[count_++] = {static_cast<float>(offset.x()), static_cast<float>(offset.y()),
                       static_cast<float>(radius), row, static_cast<std::uint32_t>(ring)};
    ++ring_sizes_[ring];
    if (count_ == near_.size()) flush();
  }

  void flush() {
    std::array<std::uint16_t, k_block> order;
    std::array<std::size_t, k_rings> next{};
    for (std::size_t r = 1; r < k_rings; ++r) next[r] = next[r - 1] + ring_sizes_[r - 1];
    for (std::size_t i = 0; i < count_; ++i) order[next[near_[i].ring]++] = static_cast<std::uint16_t>(i);
    std::uint32_t ring = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Near& body = near_[order[i]];
      if (body.ring != ring) {  // what is hidden is known only once the rings before are projected
        projector_.flush();
        ring = body.ring;
      }
      if (partition::may_meet(fan_, body.x, body.y, body.radius, inverse_)) project(Row(body.row));
    }
    projector_.flush();
    count_ = 0;
    ring_sizes_ = {};
  }

  static constexpr std::size_t k_block = 512;
  static constexpr std::size_t k_rings = 16;  // of equal area
  struct Near {
    float x, y, radius;
    std::uint32_t row, ring;
  };

  void project(Row body) {
    const std::span<const Vec2> vertices = world_.outline(body);
    const double base = world_.poses()[body.index()].z;
    for (const engine::RayOutline& outline : world_.type(body).outlines) {
      if (!outline.z.shifted(base).contains(z_)) continue;
      const std::span<const Vec2> ring = vertices.subspan(outline.first, outline.count);
      for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
        projector_.add(ring[j], ring[i], outline.ranger_return);
    }
  }

  const engine::World& world_;
  Row self_;
  Vec2 reference_;
  double z_;
  const partition::Fan& fan_;
  std::span<const float> inverse_;
  Projector& projector_;
  std::array<Near, k_block> near_;
  std::size_t count_ = 0;
  std::array<std::size_t, k_rings> ring_sizes_{};
};

void cast(const engine::World& world, const RangerBeams& ranger, const BeamGroup& group, Row row,
          std::span<float> ranges, std::span<float> intensities) {
  const Transform pose(world.poses()[row.index()]);
  const Vec2 reference = pose * ranger.reference;
  const double z = world.poses()[row.index()].z + group.z;

  std::array<float, k_fan> dx, dy, ox, oy;
  for (std::size_t i = 0; i < group.count; ++i) {
    const std::size_t beam = group.first + i;
    const Vec2 direction = pose.rotation * Vec2(ranger.dx[beam], ranger.dy[beam]);
    const Vec2 origin = pose.rotation * Vec2(ranger.ox[beam], ranger.oy[beam]);
    dx[i] = static_cast<float>(direction.x());
    dy[i] = static_cast<float>(direction.y());
    ox[i] = ranger.common_origin ? 0.0f : static_cast<float>(origin.x());
    oy[i] = ranger.common_origin ? 0.0f : static_cast<float>(origin.y());
  }
  const partition::Fan fan{{dx.data(), group.count},
                           {dy.data(), group.count},
                           {ox.data(), group.count},
                           {oy.data(), group.count},
                           ranger.common_origin};

  // The readings' own place serves as the inverse-depth buffer.
  const std::span<float> inverse = ranges.subspan(group.first, group.count);
  const std::span<float> returns =
      intensities.empty() ? std::span<float>() : intensities.subspan(group.first, group.count);
  std::ranges::fill(inverse, 0.0f);
  std::ranges::fill(returns, 0.0f);
  Projector projector(fan, reference, inverse, returns);

  // Culls may keep too much but never too little: their margins are above what rounding can take away. Bodies
  // go first, from near to far, because in a crowd they soon hide everything else.
  const double reach = ranger.reach * (1 + partition::k_range_slack) + 1e-6;
  const auto sight = [&] {  // how far the farthest beam can still go
    double farthest = 0;
    for (std::size_t i = 0; i < group.count; ++i)
      farthest =
          std::max<double>(farthest, partition::range_of(inverse[i], ranger.range_max[group.first + i]));
    return std::min(reach, (farthest + ranger.spread) * (1 + partition::k_range_slack) + 1e-6);
  };
  constexpr double k_at_hand = 0.3;  // of the reach: in a dense crowd hardly anything is seen beyond
  NearBodies bodies(world, row, reference, z, fan, inverse, projector);
  bodies.project_between(0, k_at_hand * reach);
  if (const double left = sight(); left > k_at_hand * reach) bodies.project_between(k_at_hand * reach, left);

  const double far = sight();
  const partition::StaticScene& scene = world.scene();
  scene.ranger_edges().for_each_run(
      Box::around(reference, far), [&](std::span<const partition::FixedEdge> edges) {
        for (const partition::FixedEdge& edge : edges) {
          const partition::FixedSolid& solid = scene.solids()[edge.solid];
          if (!solid.solid.z.contains(z) || box_distance2(edge.a, edge.b, reference) > far * far) continue;
          projector.add(edge.a, edge.b, solid.ranger_return);
        }
      });
  projector.flush();

  for (std::size_t i = 0; i < group.count; ++i) {
    const float range_max = ranger.range_max[group.first + i];
    if (!returns.empty() && !(inverse[i] > 1.0f / range_max)) returns[i] = 0;
    inverse[i] = partition::range_of(inverse[i], range_max);
  }
}

std::uint64_t sense(const engine::World& world, const std::any& data, std::span<const Row> rows,
                    engine::StateTable& percepts) {
  const RangerBeams& ranger = *std::any_cast<RangerBeams>(&data);
  for (const Row row : rows) {
    const std::span<float> ranges = percepts.cell<float>(world.slot(row), 0);
    const std::span<float> intensities =
        ranger.intensity ? percepts.cell<float>(world.slot(row), 1) : std::span<float>();
    for (const BeamGroup& group : ranger.groups) cast(world, ranger, group, row, ranges, intensities);
  }
  return rows.size() * ranger.dx.size();
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
