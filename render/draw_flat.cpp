#include "base/assert.hpp"
#include "render/scene_layers.hpp"
#include "render/solid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

namespace troupe::render {
namespace {

using engine::FrameBody;
using engine::FrameScene;
using engine::FrameType;

/// Robots narrower than this, in strokes (Framing::stroke, the unit of line widths), are drawn as dots: their
/// shape would not be visible, and drawing 100,000 shapes takes long.
constexpr double k_smallest_shaped = 5;

/// For each type, the factor by which its bodies are enlarged in the picture, so that they are at least
/// `smallest` pixels wide; 1 for bodies that are wide enough.
std::vector<double> enlargements(const FrameScene& scene, const Framing& framing, double smallest) {
  std::vector<double> scales;
  for (const FrameType& type : scene.types) {
    const double across = 2 * type.radius * framing.pixels_per_metre;
    scales.push_back(across > 0 && across < smallest ? smallest / across : 1.0);
  }
  return scales;
}

/// Instances of bodies, by type.
struct Instances {
  std::vector<std::vector<Instance>> moving;  ///< bodies that are not drawn as stalled
  /// Bodies drawn as stalled, with a red outline: their last motion was blocked or out of bounds.
  std::vector<std::vector<Instance>> stalled;
};

/// The instances of those `bodies` that are in the picture, by type.
///
/// left_out: one per type: 1 if bodies of the type are left out; empty: no type is left out
/// colors: one colour per body; empty: bodies have their own colours
/// smallest: narrower bodies are enlarged to this width, pixels; 0: no body is enlarged
/// shows_stalls: whether bodies with FrameBody::stalled are drawn as stalled
Instances instances_by_type(const FrameScene& scene, const std::vector<FrameBody>& bodies,
                            std::span<const std::uint8_t> left_out, std::span<const Rgba> colors,
                            const Framing& framing, double smallest, bool shows_stalls) {
  const std::vector<double> scales = enlargements(scene, framing, smallest);
  const Box world = framing.world();
  Instances instances;
  instances.moving.resize(scene.types.size());
  instances.stalled.resize(scene.types.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const FrameBody& body = bodies[i];
    TROUPE_ASSERT(body.type < scene.types.size());
    if (!left_out.empty() && left_out[body.type] != 0) continue;
    const double scale = scales[body.type];
    const Vec2 position = body.pose_world_body.position();
    const double reach =
        scene.types[body.type].radius * scale + 2 * framing.stroke / framing.pixels_per_metre;
    if (!Box::around(position, reach).touches(world)) continue;
    const Vec2 place = framing.to_pixels(position);
    const SinCos heading = sincos(body.pose_world_body.heading);
    const Rgba color = colors.empty() ? to_rgba(body.color) : colors[i];
    const bool is_stalled = shows_stalls && body.stalled;
    (is_stalled ? instances.stalled : instances.moving)[body.type].push_back(
        {static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(heading.cos),
         static_cast<float>(heading.sin), static_cast<float>(body.pose_world_body.z),
         static_cast<float>(scale * framing.pixels_per_metre), color,
         is_stalled ? k_stalled_edge : darker(color), contrasting(color)});
  }
  return instances;
}

}  // namespace

Layer flat(Mesh mesh, bool on_top) { return {std::move(mesh), {{0, 0, 1, 0, 0, 1, {}, {}, {}}}, on_top}; }

// Static bodies have a shadow on the floor, which sets them off from the background.
void add_flat_fixed(std::vector<AnyLayer>& layers, const Content& content,
                    const std::vector<FrameBody>& bodies, const Framing& framing) {
  const FrameScene& scene = content.scene();
  const auto by_type = instances_by_type(scene, bodies, {}, {}, framing, 0, false).moving;
  std::vector<Layer> shadows;
  std::vector<Layer> fixed;
  for (std::size_t type = 0; type < by_type.size(); ++type) {
    if (by_type[type].empty()) continue;
    const MeshStyle style{.edge = static_cast<float>(framing.stroke)};
    fixed.push_back(
        {body_mesh(scene.types[type], content.meshes.pieces[type], style), by_type[type], fixed.empty()});
    if (!content.layers.shadows) continue;
    shadows.push_back({silhouette(fixed.back().mesh), by_type[type], shadows.empty()});
    for (Instance& instance : shadows.back().instances) {
      instance.x += static_cast<float>(2 * framing.stroke);
      instance.y -= static_cast<float>(2 * framing.stroke);
      instance.body = content.theme.shadow;
    }
  }
  std::ranges::move(shadows, std::back_inserter(layers));
  std::ranges::move(fixed, std::back_inserter(layers));
}

void add_flat_mobile(std::vector<AnyLayer>& layers, const Content& content, const Framing& framing) {
  const FrameScene& scene = content.scene();
  const std::vector<FrameBody>& bodies = content.frame.mobile;
  std::vector<double> across;  // diameter of each type, strokes
  for (const FrameType& type : scene.types)
    across.push_back(2 * type.radius * framing.pixels_per_metre / framing.stroke);
  // Robots are drawn over the floor plan, whatever their heights, so that the floor plan never hides them.
  bool first = true;
  std::vector<std::uint8_t> is_dot;
  std::vector<double> tops;
  for (std::size_t type = 0; type < scene.types.size(); ++type) {
    is_dot.push_back(across[type] < k_smallest_shaped && !scene.types[type].shapes.empty());
    tops.push_back(heights_of(scene.types[type]).max);
  }
  PointLayer dots{.size = static_cast<float>(k_smallest_robot * framing.stroke), .on_map = true};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const FrameBody& body = bodies[i];
    if (is_dot[body.type] == 0) continue;
    const Vec2 place = framing.to_pixels(body.pose_world_body.position());
    if (std::abs(place.x()) > framing.width || std::abs(place.y()) > framing.height) continue;
    dots.points.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()),
                           static_cast<float>(body.pose_world_body.z + tops[body.type]),
                           content.color_of(i)});
  }
  if (!dots.points.empty()) {
    dots.on_top = std::exchange(first, false);
    layers.emplace_back(std::move(dots));
  }

  const auto by_type = instances_by_type(scene, bodies, is_dot, content.colors, framing,
                                         k_smallest_robot * framing.stroke, content.layers.stalls);
  for (std::size_t type = 0; type < scene.types.size(); ++type) {
    if (by_type.moving[type].empty() && by_type.stalled[type].empty()) continue;
    MeshStyle style{.least_edged = k_smallest_outlined * framing.stroke / framing.pixels_per_metre};
    if (across[type] >= k_smallest_outlined)
      style.edge = static_cast<float>(framing.stroke * std::clamp(0.08 * across[type], 0.8, 1.6));
    style.mark = content.layers.headings && scene.types[type].mobile && across[type] >= k_smallest_marked;
    for (const auto* instances : {&by_type.moving[type], &by_type.stalled[type]}) {
      if (instances == &by_type.stalled[type]) {
        style.edge *= k_stalled_widening;
        style.halo = style.edge * k_stalled_halo;
      }
      if (!instances->empty())
        layers.push_back(Layer{body_mesh(scene.types[type], content.meshes.pieces[type], style), *instances,
                               std::exchange(first, false)});
    }
  }
}

}  // namespace troupe::render
