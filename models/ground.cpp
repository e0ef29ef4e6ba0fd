#include "models/ground.hpp"

#include "engine/shown_color.hpp"
#include "engine/world.hpp"
#include "models/led.hpp"
#include "partition/box_grid.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::Element;
using engine::FieldType;
using engine::PartSpec;
using engine::Record;
using engine::Unit;
using engine::World;
using engine::WorldSpec;

/// Even-odd; of two regions that share an edge a point on it lies in one.
bool holds(const std::vector<Ring>& contours, const Vec2& point) {
  bool inside = false;
  for (const Ring& ring : contours)
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const Vec2& a = ring[j];
      const Vec2& b = ring[i];
      if ((a.y() > point.y()) == (b.y() > point.y())) continue;
      const double x = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (point.x() < x) inside = !inside;
    }
  return inside;
}

/// What lies below a point.
struct Zone {
  double top = 0;
  BodyId body;
  std::uint32_t part = 0;
  Color color;

  bool is_above(const Zone& other) const {
    if (top != other.top) return top > other.top;
    return std::tuple(body, part) < std::tuple(other.body, other.part);
  }
};

/// The flat parts of bodies that never move.
struct FixedZones {
  struct Part {
    Zone zone;
    std::vector<Ring> contours;  // world frame
  };
  std::vector<Part> parts;
  partition::BoxGrid places;
};

bool never_moves(const engine::TypeSpec& type) {
  return !type.drive && type.devices.empty() && type.controllers.empty() &&
         std::ranges::none_of(
             type.parts, [](const PartSpec& part) { return part.returns.gripper || part.returns.pushable; });
}

/// Looks at the ground: what two kinds of devices have in common.
struct Ground {
  double height = 0;
  std::vector<Vec2> points;  // body frame, or that of their joint
  Color floor;
  bool is_odd = false;  // the last point has no y
  std::shared_ptr<const FixedZones> fixed;

  void look(const WorldSpec& world) {
    FixedZones zones;
    std::vector<Box> boxes;
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
      const engine::BodySpec& body = world.bodies[b];
      const engine::TypeSpec& type = world.types[body.type.index()];
      if (!never_moves(type)) continue;
      for (std::uint32_t p = 0; p < type.parts.size(); ++p)
        for (const Solid& solid : type.parts[p].solids) {
          const double top = solid.z.max + body.pose_world_body.z;
          if (top > height) continue;
          const Color color = type.parts[p].color.value_or(body.color);
          FixedZones::Part part{{top, BodyId(b), p, color}, placed(solid, body.pose_world_body).contours};
          Box box;
          for (const Ring& ring : part.contours) box.extend(bounds(ring));
          boxes.push_back(box);
          zones.parts.push_back(std::move(part));
        }
    }
    zones.places = partition::BoxGrid(boxes);
    fixed = std::make_shared<const FixedZones>(std::move(zones));
  }

  /// Not valid, and of the floor's colour: there is nothing. Colours that devices show are to be asked for in
  /// the sense phase alone: in others they change.
  Zone below(const World& world, Row own, const Vec2& point, bool with_shown_colors) const {
    std::optional<Zone> best;
    const auto offer = [&](const Zone& zone) {
      if (!best || zone.is_above(*best)) best = zone;
    };
    const Box box = Box::around(point, 0);
    fixed->places.any_near(box, [&](std::uint32_t i) {
      if (holds(fixed->parts[i].contours, point)) offer(fixed->parts[i].zone);
      return false;
    });
    world.index().for_each_near(box, [&](const partition::BodyCircle& circle) {
      const Row row(circle.row);
      if ((Vec2(circle.x, circle.y) - point).squaredNorm() > double{circle.radius} * circle.radius) return;
      if (world.same_tree(row, own)) return;
      const engine::BodySpec& body = world.spec().bodies[world.body(row).index()];
      const std::vector<PartSpec>& parts = world.spec().types[body.type.index()].parts;
      for (std::uint32_t p = 0; p < parts.size(); ++p) {
        const engine::Mount mount = world.mount(row, parts[p].joint);
        const Vec2 local = inverse(mount).transform * point;
        for (const Solid& solid : parts[p].solids) {
          const double top = solid.z.max + mount.z;
          if (top > height || !holds(solid.contours, local)) continue;
          Color color = parts[p].color.value_or(body.color);
          if (with_shown_colors) color = engine::shown_color(world, row, p).value_or(color);
          offer({top, world.body(row), p, color});
        }
      }
    });
    return best.value_or(Zone{0, BodyId(), 0, floor});
  }
};

Result<> look(std::any& data, const WorldSpec& world) {
  std::any_cast<Ground>(&data)->look(world);
  return {};
}

std::uint64_t sense(const DeviceBatch& batch) {
  const Ground& ground = *std::any_cast<Ground>(&batch.data);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const engine::Mount mount = batch.mount(i);
    const auto colors = batch.state.cell<float>(batch.slot(i), k_ground_color);
    const auto bodies = batch.state.cell<std::uint32_t>(batch.slot(i), k_ground_body);
    for (std::size_t k = 0; k < ground.points.size(); ++k) {
      const Zone zone = ground.below(batch.world, batch.rows[i], mount.transform * ground.points[k], true);
      colors[3 * k] = zone.color.r;
      colors[3 * k + 1] = zone.color.g;
      colors[3 * k + 2] = zone.color.b;
      bodies[k] = zone.body.valid() ? zone.body.value : 0;
    }
  }
  return 0;
}

DeviceKind::Prepared prepare_sensor(const Record& params, const Pose& pose_body_sensor) {
  Ground ground{.height = params[1].number()};
  const std::vector<double>& parts = params[2].numbers();
  ground.floor = {static_cast<float>(parts[0]), static_cast<float>(parts[1]), static_cast<float>(parts[2]),
                  1};
  double reach = 0;
  const Transform place(pose_body_sensor);
  const std::vector<double>& points = params[0].numbers();
  ground.is_odd = points.size() % 2 == 1;
  for (std::size_t k = 0; k + 1 < points.size(); k += 2) {
    ground.points.push_back(place * Vec2(points[k], points[k + 1]));
    reach = std::max(reach, ground.points.back().norm());
  }
  const auto n = static_cast<std::uint32_t>(ground.points.size());
  return {.data = std::move(ground),
          .percepts = {{"color", Element::f32, 3 * n, "", "below each point: red, green, blue, from 0 to 1"},
                       {"body", Element::u32, n, "", "id of the body that has it; 0: the floor"}},
          .reach_m = reach};
}

/// A brush has one point, below itself.
void act(const DeviceBatch& batch) {
  const Ground& ground = *std::any_cast<Ground>(&batch.data);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const auto& command = batch.commands->as<BrushCommand>(batch.slot(i));
    if (command.paints == 0) continue;
    const Zone zone =
        ground.below(batch.world, batch.rows[i], batch.mount(i).transform * ground.points.front(), false);
    if (!zone.body.valid() || !batch.world.row(zone.body).valid()) continue;
    if (engine::color_device(batch.world.type(batch.world.row(zone.body)), zone.part) == nullptr) continue;
    batch.emit(i, 0, zone.part, zone.body, {command.red, command.green, command.blue});
  }
}

/// The verb is the part that is painted.
void apply(World& world, const std::any&, const engine::Effect& effect) {
  const Row target = world.row(effect.target);
  const BodyType::Device* device = engine::color_device(world.type(target), effect.verb);
  const auto shown = world.state(*device).cell<float>(world.slot(target), 0);
  bool is_new = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const double given = effect.payload[k];
    const auto part = given > 0 ? static_cast<float>(std::min(given, 1.0)) : 0.0f;
    is_new = is_new || shown[k] != part;
    shown[k] = part;
  }
  const Row source = world.row(effect.source);
  const BodyType::Device& brush = world.type(source).devices[effect.device];
  world.state(brush).as<BrushState>(world.slot(source)).painted += is_new;
}

constexpr double k_flat = 0.05;  // m

engine::Field height_field() {
  return {.name = "height",
          .unit = Unit::meters,
          .fallback = k_flat,
          .min = 0,
          .max = 10,
          .text = "of what has a higher top nothing is ground"};
}

}  // namespace

DeviceKind ground_kind() {
  DeviceKind kind{.name = "ground", .text = "sees the colour of the ground below some points of its robot"};
  kind.params = {{
      {.name = "points",
       .type = FieldType::numbers,
       .unit = Unit::meters,
       .fallback = std::vector<double>{0, 0},
       .min = -100,
       .max = 100,
       .text = "where it looks down, in its own frame: x, y of each point, one after another"},
      height_field(),
      {.name = "floor",
       .type = FieldType::numbers,
       .fallback = std::vector<double>{1, 1, 1},
       .min = 0,
       .max = 1,
       .text = "the colour of the floor, where nothing lies on it: red, green, blue",
       .columns = 3},
  }};
  kind.prepare = prepare_sensor;
  kind.mount = [](std::any& data, const engine::TypeSpec&, std::uint32_t) -> Result<> {
    const Ground& ground = *std::any_cast<Ground>(&data);
    if (!ground.points.empty() && !ground.is_odd) return {};
    return Error{"needs \"points\": x and y of each, one after another"};
  };
  kind.look = look;
  kind.sense = sense;
  return kind;
}

DeviceKind brush_kind() {
  DeviceKind kind{.name = "brush", .text = "paints the zone below it, if that carries an led"};
  kind.params = {{height_field()}};
  kind.prepare = [](const Record& params, const Pose& pose_body_brush) {
    Ground ground{.height = params[0].number(), .points = {pose_body_brush.position()}};
    return DeviceKind::Prepared{.data = std::move(ground),
                                .percepts = engine::memory_fields<BrushState>(),
                                .percept_bytes = sizeof(BrushState),
                                .commands = engine::memory_fields<BrushCommand>(),
                                .command_bytes = sizeof(BrushCommand),
                                .most_effects = 1};
  };
  kind.look = look;
  kind.act = act;
  kind.apply = apply;
  return kind;
}

}  // namespace troupe::models
