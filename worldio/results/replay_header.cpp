#include "worldio/results/replay_header.hpp"

#include "engine/observing/frame.hpp"
#include "engine/sensing/shown_color.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

namespace troupe::worldio {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string color_text(const Color& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", to_byte(color.r), to_byte(color.g), to_byte(color.b));
}

/// Returns the corners of a ring as a list x, y, x, y, ... of multiples of k_replay_shape_m.
OrderedJson corners_json(const Ring& ring) {
  OrderedJson corners = OrderedJson::array();
  for (const Vec2& point : ring)
    for (const double x : {point.x(), point.y()}) corners.push_back(std::llround(x / k_replay_shape_m));
  return corners;
}

OrderedJson pose_list(const Pose& pose) { return {pose.x, pose.y, pose.z, pose.heading}; }

/// Returns a shape as JSON: its top as convex polygons and its walls as closed chains of corners. shown:
/// index of the shape's part in the list of parts whose colour devices set; -1: the part is not in this list.
OrderedJson shape_json(const engine::FrameShape& shape, std::int32_t joint, int shown) {
  OrderedJson json;
  if (joint != engine::k_rigid) json["joint"] = joint;
  if (shown >= 0) json["shown"] = shown;
  json["z_m"] = {shape.solid.z.min, shape.solid.z.max};
  if (shape.color) json["color"] = color_text(*shape.color);
  json["walls"] = OrderedJson::array();
  for (const Ring& ring : shape.solid.contours) json["walls"].push_back(corners_json(ring));
  json["tops"] = OrderedJson::array();
  try {
    for (const ConvexPrism& piece : convex_pieces(shape.solid))
      json["tops"].push_back(corners_json(piece.outline));
  } catch (const std::length_error&) {
    // If contours cross too often to be divided into convex polygons, the shape is drawn without a top.
  }
  return json;
}

OrderedJson type_json(const RecordedScene::Type& type) {
  OrderedJson json;
  json["name"] = type.name;
  json["mobile"] = type.look.mobile;
  json["radius_m"] = type.look.radius;
  json["shapes"] = OrderedJson::array();
  std::vector<int> shown;  // by part
  OrderedJson shown_parts = OrderedJson::array();
  for (const std::string& component : type.part_colors) {
    shown.push_back(component.empty() ? -1 : static_cast<int>(shown_parts.size()));
    if (!component.empty()) shown_parts.push_back(component);
  }
  for (std::size_t s = 0; s < type.look.shapes.size(); ++s)
    json["shapes"].push_back(
        shape_json(type.look.shapes[s], type.shape_joints[s], shown[type.shape_parts[s]]));
  json["joints"] = OrderedJson::array();
  for (const RecordedScene::Joint& joint : type.joints) {
    OrderedJson& said = json["joints"].emplace_back();
    said["component"] = joint.component;
    if (joint.parent != engine::k_rigid) said["parent"] = joint.parent;
    said["pose"] = pose_list(joint.pose_body_joint);
  }
  if (!type.shown_color.empty()) json["shown_color"] = type.shown_color;
  if (!shown_parts.empty()) json["shown_parts"] = std::move(shown_parts);
  json["eyes"] = OrderedJson::object();
  for (const RecordedScene::Ranger& ranger : type.rangers) {
    OrderedJson fans = OrderedJson::array();
    for (const RecordedScene::Transducer& transducer : ranger.transducers)
      fans.push_back({{"pose", pose_list(transducer.pose_body_transducer)},
                      {"range_max_m", transducer.range_max_m},
                      {"fov_rad", transducer.fov_rad},
                      {"beams", transducer.beams}});
    json["eyes"][ranger.name]["fans"] = std::move(fans);
    if (ranger.joint != engine::k_rigid) json["eyes"][ranger.name]["joint"] = ranger.joint;
  }
  return json;
}

/// Returns the visible bodies that are not in the recording, because they are static: those not in `ids`.
OrderedJson fixed_json(std::span<const std::uint32_t> ids, const RecordedScene& scene) {
  std::vector<std::uint8_t> moves(scene.bodies.size(), 0);
  for (const std::uint32_t id : ids) moves[id] = 1;
  OrderedJson fixed = OrderedJson::array();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const RecordedScene::Body& body = scene.bodies[b];
    if (moves[b] != 0 || scene.types[body.type].look.shapes.empty()) continue;
    fixed.push_back(
        {{"type", body.type}, {"pose", pose_list(body.pose_world_body)}, {"color", color_text(body.color)}});
  }
  return fixed;
}

/// Returns the robots of a page as JSON: the runs of consecutive rows of one type, and the id, name and
/// colour of each row.
OrderedJson robots_json(std::span<const std::uint32_t> ids_in_order, const RecordedScene& scene) {
  std::vector<std::array<std::uint32_t, 2>> types;
  OrderedJson ids = OrderedJson::array();
  OrderedJson names = OrderedJson::array();
  OrderedJson colors = OrderedJson::array();
  for (const std::uint32_t id : ids_in_order) {
    const RecordedScene::Body& body = scene.bodies[id];
    if (types.empty() || types.back()[0] != body.type) types.push_back({body.type, 0});
    ++types.back()[1];
    ids.push_back(id);
    names.push_back(body.name);
    colors.push_back(color_text(body.color));
  }
  return {{"types", types}, {"id", std::move(ids)}, {"name", std::move(names)}, {"color", std::move(colors)}};
}

OrderedJson field_json(const ReplayField& field) {
  OrderedJson runs = OrderedJson::array();
  for (const ReplayRun& run : field.runs) runs.push_back({run.first, run.count});
  const engine::StateField& what = field.array->field;
  return {{"component", field.array->component},
          {"name", what.name},
          {"unit", what.unit},
          {"text", what.text},
          {"columns", what.columns},
          {"rows", std::move(runs)},
          {"min", field.min},
          {"max", field.max},
          {"step", field.step},
          {"steps", field.steps}};
}

OrderedJson bounds_json(const Box& bounds) {
  return {bounds.min.x(), bounds.min.y(), bounds.max.x(), bounds.max.y()};
}

OrderedJson types_json(const RecordedScene& scene) {
  OrderedJson types = OrderedJson::array();
  for (const RecordedScene::Type& type : scene.types) types.push_back(type_json(type));
  return types;
}

/// The part of the floor that a page shows first. In a world without bodies (they may all be in a reserve),
/// this is the rectangle that robots may not leave, or 10 m of floor.
Box bounds_of_page(const engine::FrameScene& scene) {
  return scene.bounds.empty() ? scene.limits.value_or(Box::around(Vec2::Zero(), 5)) : scene.bounds;
}

std::string text_of(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace

LivePage live_page(const engine::World& world, const engine::Registry& registry) {
  RecordedScene scene = recorded_scene(world.spec(), registry);
  for (std::size_t t = 0; t < scene.types.size(); ++t)
    for (std::uint32_t p = 1; p < scene.types[t].part_colors.size(); ++p)
      if (const engine::BodyType::Device* device = engine::color_device(world.view().types()[t], p))
        scene.types[t].part_colors[p] = device->name;
  LivePage page;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    // Not SensingView::row(), which throws for a body whose row only another rank has.
    if (world.view().location(BodyId(b)) != engine::RowLocation::none)
      page.order.push_back(static_cast<std::uint32_t>(b));
  }
  std::ranges::stable_sort(page.order, {}, [&](std::uint32_t id) { return scene.bodies[id].type; });
  for (std::size_t first = 0, last = 0; first < page.order.size(); first = last) {
    const std::uint32_t type = scene.bodies[page.order[first]].type;
    while (last < page.order.size() && scene.bodies[page.order[last]].type == type) ++last;
    for (std::uint32_t p = 1; p < scene.types[type].part_colors.size(); ++p)
      if (!scene.types[type].part_colors[p].empty()) page.shown_parts.push_back({first, last - first, p});
  }
  OrderedJson json;
  json["title"] = scene.title;
  json["about"] = {{"world", scene.title}, {"seed", fmt::format("{}", world.spec().seed)}};
  json["bounds_m"] = bounds_json(bounds_of_page(engine::make_scene(world)));
  json["shape_step_m"] = k_replay_shape_m;
  json["types"] = types_json(scene);
  json["fixed"] = fixed_json(page.order, scene);
  json["robots"] = robots_json(page.order, scene);
  json["pose"] = {{"step_m", k_replay_step_m}, {"turn", k_replay_turn}, {"has_z", true}};
  json["fields"] = OrderedJson::array();
  page.header = text_of(json);
  return page;
}

std::string replay_header(const RecordingReader& recording, const ReplayPlan& plan,
                          std::span<const std::size_t> frames, const ReplayBlocks& blocks) {
  OrderedJson json;
  json["format"] = k_replay_format;
  json["title"] = plan.scene.title;
  json["about"] = OrderedJson::object();
  for (const auto& [key, value] : recording.meta()) json["about"][key] = value;
  json["recorded_frames"] = recording.frames();
  json["times_s"] = OrderedJson::array();
  for (const std::size_t frame : frames) json["times_s"].push_back(recording.times_s()[frame]);
  json["bounds_m"] = bounds_json(plan.bounds);
  json["shape_step_m"] = k_replay_shape_m;
  json["types"] = types_json(plan.scene);
  json["fixed"] = fixed_json(recording.ids(), plan.scene);
  std::vector<std::uint32_t> ids_in_order;
  for (const std::uint32_t row : plan.order) ids_in_order.push_back(recording.ids()[row]);
  json["robots"] = robots_json(ids_in_order, plan.scene);
  json["pose"] = {{"step_m", k_replay_step_m}, {"turn", k_replay_turn}, {"has_z", plan.pose[3] != nullptr}};
  if (!plan.pose[3]) json["pose"]["z_m"] = plan.heights;
  json["fields"] = OrderedJson::array();
  for (const ReplayField& field : plan.fields) json["fields"].push_back(field_json(field));
  json["block_frames"] = blocks.frames;
  json["block_bytes"] = blocks.bytes;
  return text_of(json);
}

}  // namespace troupe::worldio
