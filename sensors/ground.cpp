#include "sensors/ground.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/sensing/shown_color.hpp"
#include "partition/box_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace troupe::sensors {
namespace {

using engine::CommittedView;
using engine::DeviceKind;
using engine::Element;
using engine::PartSpec;
using engine::SenseBatch;
using engine::SensingView;
using engine::WorldSpec;

/// Whether a ray from the point towards +x crosses the edge between a and b. A point on an edge that two
/// regions have in common is on the same side of the edge for both.
bool crosses(const Vec2& a, const Vec2& b, const Vec2& point) {
  if ((a.y() > point.y()) == (b.y() > point.y())) return false;
  // From the lower end, so that the regions on both sides of an edge compute the same x.
  const Vec2& low = a.y() < b.y() ? a : b;
  const Vec2& high = a.y() < b.y() ? b : a;
  const double x = low.x() + (point.y() - low.y()) / (high.y() - low.y()) * (high.x() - low.x());
  return point.x() < x;
}

/// Whether the point is inside the contours, by the even-odd rule. A point on an edge that two regions have
/// in common is inside exactly one of them.
bool holds(const std::vector<Ring>& contours, const Vec2& point) {
  bool inside = false;
  for (const Ring& ring : contours)
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
      if (crosses(ring[j], ring[i], point)) inside = !inside;
  return inside;
}

/// Whether bodies of the type belong to the static scene. All other bodies are in the index of the view.
bool never_moves(const engine::TypeSpec& type) {
  return engine::is_static(type) && type.devices.empty() && type.controllers.empty();
}

}  // namespace

bool Ground::Zone::is_above(const Zone& other) const {
  if (top != other.top) return top > other.top;
  return std::tuple(body, part) < std::tuple(other.body, other.part);
}

/// The parts of static bodies that are ground.
struct Ground::Fixed {
  /// The contours of a region, for many calls of contains(), which gives the results of holds(). The edges
  /// are sorted into horizontal strips, because the contours of a floor image can have a million edges.
  class StrippedRegion {
   public:
    explicit StrippedRegion(const std::vector<Ring>& contours) {
      double edges = 0;
      double climb = 0;  // sum of the heights of the edges, m
      for_each_edge(contours, [&](const Vec2& a, const Vec2& b) {
        box_.extend(a);
        ++edges;
        climb += std::abs(b.y() - a.y());
      });
      if (edges == 0) return;
      // With this many strips, the long edges have about as many entries in total as there are edges.
      const double height = box_.size().y();
      const double strips = climb > 0 ? std::clamp(edges * height / climb, 1.0, edges) : 1.0;
      begins_.assign(static_cast<std::size_t>(strips) + 1, 0);
      per_m_ = height > 0 ? std::floor(strips) / height : 0;
      const auto for_each_entry = [&](auto&& visit) {
        for_each_edge(contours, [&](const Vec2& a, const Vec2& b) {
          if (a.y() == b.y()) return;  // no ray towards +x crosses it
          const std::size_t last = strip(std::max(a.y(), b.y()));
          for (std::size_t i = strip(std::min(a.y(), b.y())); i <= last; ++i) visit(i, Edge{a, b});
        });
      };
      for_each_entry([&](std::size_t i, const Edge&) { ++begins_[i + 1]; });
      for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
      edges_.resize(begins_.back());
      std::vector<std::size_t> next = begins_;
      for_each_entry([&](std::size_t i, const Edge& edge) { edges_[next[i]++] = edge; });
    }

    const Box& box() const { return box_; }
    bool contains(const Vec2& point) const {
      if (!(box_.min.y() <= point.y() && point.y() <= box_.max.y())) return false;
      const std::size_t i = strip(point.y());
      bool inside = false;
      for (std::size_t e = begins_[i]; e < begins_[i + 1]; ++e)
        if (crosses(edges_[e].a, edges_[e].b, point)) inside = !inside;
      return inside;
    }

   private:
    struct Edge {
      Vec2 a, b;
    };
    template <class Visit>
    static void for_each_edge(const std::vector<Ring>& contours, Visit&& visit) {
      for (const Ring& ring : contours)
        for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) visit(ring[j], ring[i]);
    }
    std::size_t strip(double y) const {
      return static_cast<std::size_t>(
          std::clamp((y - box_.min.y()) * per_m_, 0.0, static_cast<double>(begins_.size() - 2)));
    }

    Box box_;
    double per_m_ = 0;                 // strips per metre
    std::vector<std::size_t> begins_;  // per strip, and one past the end: index into edges_
    std::vector<Edge> edges_;          // by strip
  };

  struct Part {
    Zone zone;
    StrippedRegion region;  // world frame
  };
  std::vector<Part> parts;
  partition::BoxGrid places;
};

void Ground::collect(const WorldSpec& world) {
  Fixed zones;
  std::vector<Box> boxes;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const engine::BodySpec& body = world.bodies[b];
    const engine::TypeSpec& type = world.types[body.type.index()];
    if (!never_moves(type)) continue;
    for (std::uint32_t p = 0; p < type.parts.size(); ++p)
      for (const Solid& solid : type.parts[p].solids) {
        const double top = solid.z.max + body.pose_world_body.z;
        if (top > height_) continue;
        const Color color = type.parts[p].color.value_or(body.color);
        const Solid here = placed(solid, body.pose_world_body);
        zones.parts.push_back({{top, BodyId(b), p, color}, Fixed::StrippedRegion(here.contours)});
        boxes.push_back(zones.parts.back().region.box());
      }
  }
  zones.places = partition::BoxGrid(boxes);
  fixed_ = std::make_shared<const Fixed>(std::move(zones));
}

/// Implements below() for a SensingView and shown_below() for a CommittedView.
template <class View>
Ground::Zone Ground::find(const View& view, Row own, const Vec2& point) const {
  std::optional<Zone> best;
  const auto offer = [&](const Zone& zone) {
    if (!best || zone.is_above(*best)) best = zone;
  };
  const Box box = Box::around(point, 0);
  fixed_->places.any_near(box, [&](std::uint32_t i) {
    if (fixed_->parts[i].region.contains(point)) offer(fixed_->parts[i].zone);
    return false;
  });
  view.index().for_each_near(box, [&](const partition::BodyCircle& circle) {
    const Row row(circle.row);
    if ((Vec2(circle.x, circle.y) - point).squaredNorm() > double{circle.radius} * circle.radius) return;
    if (view.same_tree(row, own)) return;
    const engine::BodySpec& body = view.spec().bodies[view.body(row).index()];
    const std::vector<PartSpec>& parts = view.spec().types[body.type.index()].parts;
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
      const engine::Mount mount = view.mount(row, parts[p].joint);
      const Vec2 local = inverse(mount).transform * point;
      for (const Solid& solid : parts[p].solids) {
        const double top = solid.z.max + mount.z;
        if (top > height_ || !holds(solid.contours, local)) continue;
        Color color = parts[p].color.value_or(body.color);
        if constexpr (std::is_same_v<View, CommittedView>)
          color = engine::shown_color(view, row, p).value_or(color);
        offer({top, view.body(row), p, color});
      }
    }
  });
  return best.value_or(Zone{0, BodyId(), 0, floor_});
}

Ground::Zone Ground::below(const SensingView& view, Row own, const Vec2& point) const {
  return find(view, own, point);
}
Ground::Zone Ground::shown_below(const CommittedView& view, Row own, const Vec2& point) const {
  return find(view, own, point);
}

namespace {

struct GroundSensor {
  struct Params {
    std::vector<double> points{0, 0};
    GroundParams ground;
    std::array<float, 3> floor{1, 1, 1};

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::points>("points", engine::Unit::meters, within(-100, 100),
                                "points below which the sensor reads the colour of the ground, in the "
                                "sensor frame, as a list of numbers: x and y of the first point, x and y of "
                                "the second, ...");
      d.part<&Params::ground>();
      d.member<&Params::floor>("floor", within(0, 1), "colour of the bare floor: red, green, blue");
    }
  };

  static constexpr std::array reads{engine::k_shown_color};

  Ground ground;
  std::vector<Vec2> points;  // frame of the body, or of the joint that carries the sensor
  bool is_odd = false;       // the parameter `points` has an odd number of values: the last x has no y

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor) {
    const auto& [red, green, blue] = params.floor;
    GroundSensor sensor{.ground = Ground(params.ground, {red, green, blue, 1})};
    double reach = 0;
    const Transform place(pose_body_sensor);
    sensor.is_odd = params.points.size() % 2 == 1;
    for (std::size_t k = 0; k + 1 < params.points.size(); k += 2) {
      sensor.points.push_back(place * Vec2(params.points[k], params.points[k + 1]));
      reach = std::max(reach, sensor.points.back().norm());
    }
    const auto n = static_cast<std::uint32_t>(sensor.points.size());
    return {.data = std::move(sensor),
            .percepts = {{"color", Element::f32, 3 * n, "",
                          "colour below each point: red, green, blue, from 0 to 1"},
                         {"body", Element::u32, n, "", "id of the body whose colour is read; 0: the floor"}},
            .reach_m = reach};
  }

  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) {
    if (!points.empty() && !is_odd) return {};
    return Error{fmt::format(
        "needs an even number of values in \"points\", at least 2 (x and y of each point), found {}",
        2 * points.size() + (is_odd ? 1 : 0))};
  }

  Result<> bind_world(const WorldSpec& world) {
    ground.collect(world);
    return {};
  }

  std::uint64_t sense(const SenseBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const engine::Mount mount = batch.mount(i);
      const auto colors = batch.state.cell<float>(batch.slot(i), k_ground_color);
      const auto bodies = batch.state.cell<std::uint32_t>(batch.slot(i), k_ground_body);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Ground::Zone zone =
            ground.shown_below(batch.committed, batch.rows[i], mount.transform * points[k]);
        colors[3 * k] = zone.color.r;
        colors[3 * k + 1] = zone.color.g;
        colors[3 * k + 2] = zone.color.b;
        bodies[k] = zone.body.valid() ? zone.body.value : 0;
      }
    }
    return 0;
  }

  void lint(const engine::LintView& view) const;
};

/// For each type with bodies and solids, the lowest height of the top of a solid, m, world frame. A joint may
/// lower a solid to any height.
struct LowestTops {
  std::vector<std::pair<double, std::uint32_t>> types;  // in ascending order

  explicit LowestTops(const engine::LintWorld& world) {
    for (std::uint32_t t = 0; t < world.types.size(); ++t) {
      if (world.bodies[t] == 0) continue;
      std::optional<double> lowest;
      for (const PartSpec& part : world.spec.types[t].parts)
        for (const Solid& solid : part.solids) {
          const double top = part.joint != engine::k_rigid ? -std::numeric_limits<double>::infinity()
                                                           : solid.z.max + world.levels[t].begin()->first;
          lowest = std::min(lowest.value_or(top), top);
        }
      if (lowest) types.emplace_back(*lowest, t);
    }
    std::ranges::sort(types);
  }
};

/// Warns if no part of another body can be ground.
void GroundSensor::lint(const engine::LintView& view) const {
  if (view.is_set({"height"})) return;
  for (const auto& [top, type] : view.world.shared<LowestTops>().types) {
    if (top > ground.height()) break;
    if (view.has_other(type)) return;
  }
  view.warn(engine::LintTopic::ground,
            fmt::format("{} sees only the bare floor: no other body has a part whose top is at most {:.4g} m "
                        "above the floor, its \"height\"",
                        engine::device_text("sensor", view.device_spec().name, view.type_spec().name),
                        ground.height()));
}

}  // namespace

DeviceKind ground_kind() {
  return engine::make_device_kind<GroundSensor>(
      "ground", "reads the colour of the ground below given points of the robot");
}

}  // namespace troupe::sensors
