#include "base/assert.hpp"
#include "render/scene_layers.hpp"
#include "render/solid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

namespace troupe::render {
namespace {

using engine::FrameBody;
using engine::FrameScene;
using engine::FrameType;

/// Bodies narrower than this, in strokes (Framing::stroke, the unit of line widths), are drawn as boxes:
/// details would not be visible.
constexpr double k_smallest_prism = 10;
/// Sides shorter than this, in strokes, are taken for the steps of a bitmap and have no edge lines.
constexpr double k_shortest_side = 8;
/// Shapes narrower than this, in strokes, have no lines along their edges, because lines would hide the
/// colour of the shape.
constexpr double k_smallest_edged = 9;

/// Visible bodies of one type, by level of detail.
struct Seen {
  std::vector<SolidInstance> prisms;
  /// Prisms drawn as stalled, with a red outline: the last motion of the body was blocked or out of bounds.
  std::vector<SolidInstance> stalled;
  std::vector<SolidInstance> boxes;
  double widest = 0;            ///< width of the largest prism, strokes
  double pixels_per_metre = 0;  ///< scale of the picture at the largest prism
};

class Sorter {
 public:
  Sorter(const FrameScene& scene, const Projection& projection) : scene_(scene), projection_(projection) {
    seen_.resize(scene.types.size());
    for (const FrameType& type : scene.types) {
      const ZInterval z = heights_of(type);
      heights_.push_back(z);
      // Radius of the smallest ball around the middle of the body that contains the body.
      reaches_.push_back(std::sqrt(type.radius * type.radius + 0.25 * (z.max - z.min) * (z.max - z.min)));
    }
  }

  /// Adds a body if it is in the picture. smallest: a body narrower than this, in strokes, is added to
  /// `dots`; 0: no body is. is_stalled: whether the body is drawn as stalled.
  void add(const FrameBody& body, Rgba color, bool is_stalled, double smallest) {
    TROUPE_ASSERT(body.type < scene_.types.size());
    const FrameType& type = scene_.types[body.type];
    if (type.shapes.empty()) return;
    const ZInterval z = heights_[body.type];
    const Pose& pose = body.pose_world_body;
    const Vec3 middle(pose.x, pose.y, pose.z + 0.5 * (z.min + z.max));
    if (!projection_.may_show(middle, reaches_[body.type])) return;
    const double scale = projection_.pixels_per_metre(middle);
    const double across = 2 * type.radius * scale / projection_.stroke();
    const Vec3 place = middle - projection_.origin();
    if (scale > 0 && across < smallest) {
      dots.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()),
                      static_cast<float>(place.z()), color});
      return;
    }
    const Rgba edge = is_stalled ? k_stalled_edge : darker(color);
    const SinCos heading = sincos(pose.heading);
    const SolidInstance instance{static_cast<float>(place.x()),
                                 static_cast<float>(place.y()),
                                 static_cast<float>(pose.z),
                                 1,
                                 static_cast<float>(heading.cos),
                                 static_cast<float>(heading.sin),
                                 color,
                                 edge,
                                 contrasting(color)};
    if (scale > 0 && across < k_smallest_prism) {
      seen_[body.type].boxes.push_back(instance);
    } else {
      Seen& seen = seen_[body.type];
      (is_stalled ? seen.stalled : seen.prisms).push_back(instance);
      if (across > seen.widest) {
        seen.widest = across;
        seen.pixels_per_metre = scale;
      }
    }
  }

  const Seen& seen(std::size_t type) const { return seen_[type]; }
  std::vector<Point> dots;  ///< bodies of all types that are drawn as dots

 private:
  const FrameScene& scene_;
  const Projection& projection_;
  std::vector<ZInterval> heights_;
  std::vector<double> reaches_;
  std::vector<Seen> seen_;
};

SolidLayer shadow_of(const SolidLayer& layer, Rgba color) {
  SolidLayer shadow{shadow_mesh(layer.mesh), layer.instances, SolidLayer::Depth::floor, true};
  for (SolidInstance& instance : shadow.instances) instance.edge = color;
  return shadow;
}

void add_type(std::vector<SolidLayer>& layers, const SceneMeshes& meshes, std::size_t type, const Seen& seen,
              const Projection& projection, bool shows_marks) {
  const FrameType& shapes = meshes.scene.types[type];
  if (!seen.boxes.empty()) layers.push_back({box_mesh(shapes), seen.boxes});
  if (seen.prisms.empty() && seen.stalled.empty()) return;
  SolidStyle style;
  const double stroke = projection.stroke();
  style.edge = static_cast<float>(stroke * std::clamp(0.06 * seen.widest, 0.7, 1.3));
  style.mark = shows_marks && shapes.mobile;
  if (seen.pixels_per_metre > 0) {
    style.least_side = k_shortest_side * stroke / seen.pixels_per_metre;
    style.least_edged = k_smallest_edged * stroke / seen.pixels_per_metre;
  }
  if (!seen.prisms.empty()) layers.push_back({prism_mesh(shapes, meshes.pieces[type], style), seen.prisms});
  if (seen.stalled.empty()) return;
  style.edge *= k_stalled_widening;
  style.halo = style.edge * k_stalled_halo;
  layers.push_back({prism_mesh(shapes, meshes.pieces[type], style), seen.stalled});
}

}  // namespace

void add_solids(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection,
                std::vector<AnyLayer> on_floor, std::vector<AnyLayer> in_air) {
  const FrameScene& scene = content.scene();
  const std::vector<FrameBody>& bodies = content.frame.mobile;
  const Layers& shown = content.layers;
  Sorter fixed(scene, projection);
  for (const FrameBody& body : scene.fixed) fixed.add(body, to_rgba(body.color), false, 0);
  Sorter mobile(scene, projection);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    mobile.add(bodies[i], content.color_of(i), shown.stalls && bodies[i].stalled, k_smallest_robot);

  PointLayer dots{std::move(mobile.dots), static_cast<float>(k_smallest_robot * projection.stroke())};
  std::vector<SolidLayer> standing;
  std::vector<SolidLayer> moving;
  for (std::size_t type = 0; type < scene.types.size(); ++type) {
    add_type(standing, content.meshes, type, fixed.seen(type), projection, false);
    add_type(moving, content.meshes, type, mobile.seen(type), projection, shown.headings);
  }
  if (shown.shadows) {
    for (const SolidLayer& layer : standing) layers.emplace_back(shadow_of(layer, content.theme.shadow));
    for (const SolidLayer& layer : moving) layers.emplace_back(shadow_of(layer, content.theme.shadow));
  }
  std::ranges::move(on_floor, std::back_inserter(layers));
  std::ranges::move(standing, std::back_inserter(layers));
  std::ranges::move(in_air, std::back_inserter(layers));
  std::ranges::move(moving, std::back_inserter(layers));
  if (!dots.points.empty()) layers.emplace_back(std::move(dots));
}

}  // namespace troupe::render
