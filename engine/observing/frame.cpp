#include "engine/observing/frame.hpp"

#include "engine/sensing/shown_color.hpp"
#include "engine/world/world.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace troupe::engine {
namespace {

/// A look is the shapes and colours with which a body is drawn (FrameType). This map has the looks of a frame
/// that differ from the looks of the scene (FrameScene::types) only in colours. Key: the type, and the
/// colours from colors_of_parts(). Value: the index of the look (FrameBody::type). Bodies that look alike
/// share a look, because a viewer draws all bodies of one look at once.
using LooksByColor = std::map<std::pair<std::uint32_t, std::vector<float>>, std::uint32_t>;

/// The colours that devices give to the parts of a body, except its root part: red, green and blue for each
/// such device. Empty if there are none.
std::vector<float> colors_of_parts(const CommittedView& view, Row row) {
  std::vector<float> colors;
  for (const BodyType::Device& device : view.type(row).devices) {
    if (device.part == 0 || !device.kind->shows_color) continue;
    const std::span<const float> shown = view.percepts(device).cell<float>(view.slot(row), 0);
    colors.insert(colors.end(), shown.begin(), shown.begin() + 3);
  }
  return colors;
}

/// Returns the shapes and the radius of the body of `row` as they are drawn, with its joints where they are
/// now and its parts in the colours that devices give them. If `row` is not valid, the joints are at rest and
/// the colours are those of the world file. `t`: index of the body's type.
FrameType look_of(const WorldState& state, std::size_t t, Row row) {
  FrameType look{.mobile = state.types[t].drive.has_value(), .name = state.spec.types[t].name};
  const std::vector<PartSpec>& parts = state.spec.types[t].parts;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const PartSpec& part = parts[p];
    // FrameBody::color is the colour of the root part.
    const std::optional<Color> shown =
        row.valid() && p > 0 ? shown_color(state.view, row, p) : std::optional<Color>();
    for (const Solid& solid : part.solids) {
      look.shapes.push_back({solid, shown ? shown : part.color});
      if (part.joint == k_rigid || !row.valid()) continue;
      const Mount& now = state.mounts(row)[static_cast<std::size_t>(part.joint)];
      Solid& moved = look.shapes.back().solid;
      for (Ring& ring : moved.contours)
        for (Vec2& point : ring) point = now.transform * point;
      moved.z = moved.z.shifted(now.z);
    }
  }
  look.radius = enclosing_radius(look.shapes);
  return look;
}

}  // namespace

FrameScene make_scene(const World& world) {
  const WorldState& state = world.state();
  FrameScene scene;
  scene.title = state.spec.title;
  for (std::size_t t = 0; t < state.types.size(); ++t) scene.types.push_back(look_of(state, t, Row()));
  scene.bounds = state.scene.bounds();
  scene.tile_m = state.geometry.tile_m();
  scene.cell_m = state.geometry.cell_m;
  scene.limits = state.spec.bounds;
  for (std::size_t b = 0; b < state.spec.bodies.size(); ++b) {
    const BodySpec& body = state.spec.bodies[b];
    if (state.view.location(BodyId(b)) == RowLocation::none)
      scene.fixed.push_back(
          {body.type.value, body.pose_world_body, body.color, false, static_cast<std::uint32_t>(b)});
    else if (state.spec.starts(BodyId(b)))
      scene.bounds.extend(
          Box::around(body.pose_world_body.position(), scene.types[body.type.index()].radius));
  }
  return scene;
}

Frame make_frame(const World& world) {
  world.require_whole();
  world.gather();  // the colours of parts are read from the states of devices
  const WorldState& state = world.state();
  const CommittedView& view = state.view;
  Frame frame{view.time_s(), view.tick(), {}};
  frame.mobile.reserve(view.rows());
  LooksByColor looks;
  for (std::size_t b = 0; b < state.rows.size(); ++b) {
    const BodySpec& body = state.spec.bodies[b];
    if (view.location(BodyId(b)) != RowLocation::here) continue;
    const Row r = view.row(BodyId(b));
    if (!view.is_there(r)) continue;
    const Color color = shown_color(view, r, 0).value_or(body.color);
    frame.mobile.push_back(
        {body.type.value, view.poses()[r.index()], color, view.stalled(r), static_cast<std::uint32_t>(b)});
    const auto next = static_cast<std::uint32_t>(state.types.size() + frame.types.size());
    std::uint32_t look = next;
    if (view.type(r).joints.empty() || std::ranges::all_of(state.mounts(r), is_identity)) {
      const std::vector<float> colors = colors_of_parts(view, r);
      if (colors.empty()) continue;
      look = looks.try_emplace({body.type.value, colors}, next).first->second;
    }
    frame.mobile.back().type = look;
    if (look == next) frame.types.push_back(look_of(state, body.type.value, r));
  }
  return frame;
}

}  // namespace troupe::engine
