#include "render/draw.hpp"

#include "render/canvas.hpp"
#include "render/framing.hpp"
#include "render/map_furniture.hpp"
#include "render/mesh.hpp"
#include "render/overlays.hpp"
#include "render/scene_layers.hpp"
#include "render/solid_mesh.hpp"
#include "render/theme.hpp"
#include "render/value_colors.hpp"
#include "render/vector_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <utility>

namespace troupe::render {
namespace {

using engine::Frame;
using engine::FrameBody;
using engine::FrameScene;

// A stroke is one pixel in pictures whose smaller side has at most this many pixels.
constexpr double k_rows_of_one_stroke = 900;
constexpr double k_margin = 0.03;        // margin around the scene, fraction of the picture's smaller side
constexpr double k_furniture_band = 40;  // height below the scene for scale bar and clock, strokes
/// On a map, static bodies whose tops are at most this high, m, belong to the floor, as coloured zones do:
/// the overlays in the air are drawn over them. The sensor `ground` reads the colours of bodies up to this
/// height by default. Sensors may be mounted lower than the top of a zone, so the heights of the overlays do
/// not tell.
constexpr double k_floor_m = 0.05;

/// Restores the floating-point environment of the calling thread when it is destroyed. The OpenGL driver
/// changes this environment (rounding, denormals).
class KeepFpEnvironment {
 public:
  KeepFpEnvironment() { std::fegetenv(&environment_); }
  ~KeepFpEnvironment() { std::fesetenv(&environment_); }
  KeepFpEnvironment(const KeepFpEnvironment&) = delete;
  KeepFpEnvironment& operator=(const KeepFpEnvironment&) = delete;

 private:
  std::fenv_t environment_;
};

/// The region of the world to show if the camera does not determine it, m. It is never empty. Throws
/// std::runtime_error if View::region is not finite or has no area.
Box shown_bounds(const FrameScene& scene, const View& view) {
  Box shown = view.region.value_or(scene.bounds);
  if (view.layers.bounds && !view.region && scene.limits) shown.extend(*scene.limits);
  if (view.region) {
    if (!shown.min.allFinite() || !shown.max.allFinite() || !((shown.size().array() > 0).all()))
      throw std::runtime_error(fmt::format(
          "cannot draw: the region of the view must be finite and of positive size, found [[{:.10g}, "
          "{:.10g}], [{:.10g}, {:.10g}]]",
          shown.min.x(), shown.min.y(), shown.max.x(), shown.max.y()));
    return shown;
  }
  if (shown.empty()) shown = Box::around(Vec2::Zero(), 5);  // an empty world: show 10 m of floor
  if ((shown.size().array() <= 0).any()) shown = shown.expanded(0.5);
  return shown;
}

/// A framing of which only size and stroke are set. The caller must set centre and scale.
Framing empty_framing(const View& view) {
  Framing framing{view.width, view.height};
  framing.stroke = std::max(1.0, std::min(view.width, view.height) / k_rows_of_one_stroke);
  return framing;
}

/// Height below the scene for the scale bar and the simulated time, in addition to the margin, pixels.
double furniture_band(const Framing& framing, double margin) {
  return framing.has_furniture() ? std::max(0.0, k_furniture_band * framing.stroke - margin) : 0;
}

Framing frame_from_above(const FrameScene& scene, const View& view) {
  Framing framing = empty_framing(view);
  const Box shown = shown_bounds(scene, view);
  const double margin = view.region ? 0 : k_margin * std::min(view.width, view.height);
  const double band = view.region ? 0 : furniture_band(framing, margin);
  const double wide = view.width - 2 * margin;
  const double high = view.height - 2 * margin - band;
  framing.pixels_per_metre = std::min(wide / shown.size().x(), high / shown.size().y());
  framing.center = shown.center() - Vec2(0, 0.5 * band / framing.pixels_per_metre);
  if (view.camera.across_m) {
    framing.pixels_per_metre = view.width / *view.camera.across_m;
    framing.center = shown.center();
  }
  if (view.camera.center) framing.center = {view.camera.center->x(), view.camera.center->y()};
  return framing;
}

/// An interval that contains the heights of the floor and of all `bodies`, world frame, m.
ZInterval heights_in(const FrameScene& scene, const std::vector<FrameBody>& bodies) {
  ZInterval heights{0, 0.01};
  std::vector<ZInterval> of_types;
  for (const engine::FrameType& type : scene.types) {
    of_types.push_back(heights_of(type));
    heights.max = std::max(heights.max, of_types.back().max);
  }
  for (const FrameBody& body : bodies) {
    heights.min = std::min(heights.min, body.pose_world_body.z + of_types[body.type].min);
    heights.max = std::max(heights.max, body.pose_world_body.z + of_types[body.type].max);
  }
  return heights;
}

/// The greatest height of the overlays of a frame that are above the floor, world frame, m; 0 without such
/// overlays.
double top_of_overlays(const FrameScene& scene, const Frame& frame) {
  double top = 0;
  const auto add = [&top](const Vec3& point) { top = std::max(top, point.z()); };
  for (const engine::FrameScan& scan : frame.scans) {
    const double mount = frame.mobile[scan.body].pose_world_body.z + scan.moved.z;
    for (const engine::FrameTransducer& transducer : scene.rangers[scan.ranger].transducers)
      top = std::max(top, mount + transducer.pose_body.z);
  }
  for (const engine::FrameSight& sight : frame.sights) {
    add(sight.from);
    add(sight.to);
  }
  for (const engine::FrameBlob& blob : frame.blobs)
    for (const Vec3& point : {blob.from, blob.right, blob.left}) add(point);
  for (const std::vector<engine::FrameTie>* ties : {&frame.grips, &frame.links}) {
    for (const engine::FrameTie& tie : *ties) {
      add(tie.from);
      add(tie.to);
    }
  }
  for (const engine::FrameTrail& trail : frame.trails)
    for (const Vec3& point : trail.points) add(point);
  return top;
}

/// The static bodies of a scene.
struct FixedBodies {
  std::vector<FrameBody> of_floor;  ///< bodies that belong to the floor: see k_floor_m
  std::vector<FrameBody> others;
};

FixedBodies fixed_bodies(const FrameScene& scene) {
  FixedBodies bodies;
  for (const FrameBody& body : scene.fixed) {
    const double top = body.pose_world_body.z + heights_of(scene.types[body.type]).max;
    (top <= k_floor_m ? bodies.of_floor : bodies.others).push_back(body);
  }
  return bodies;
}

std::vector<Vec3> corners_of(const Box& box, const ZInterval& z) {
  std::vector<Vec3> corners;
  for (const double x : {box.min.x(), box.max.x()})
    for (const double y : {box.min.y(), box.max.y()})
      for (const double height : {z.min, z.max}) corners.emplace_back(x, y, height);
  return corners;
}

Projection project(const FrameScene& scene, const Frame& frame, const View& view, const Framing& framing) {
  const Camera& camera = view.camera;
  Projection projection(view.width, view.height, framing.stroke, camera.pitch, camera.yaw,
                        camera.perspective ? camera.fov : 0);
  ZInterval heights = heights_in(scene, scene.fixed);
  const Box shown = shown_bounds(scene, view);
  const double margin = k_margin * std::min(view.width, view.height);
  projection.fit(corners_of(shown, heights), margin, furniture_band(framing, margin));
  if (camera.eye && camera.perspective) {
    projection.stand_at(*camera.eye);
  } else if (camera.center || camera.across_m) {
    const Vec3 center = camera.center.value_or(Vec3(shown.center().x(), shown.center().y(), 0));
    // If no width is given, keeps the scale at which the whole scene is visible.
    const double scale = projection.pixels_per_metre(projection.floor_center());
    const double across = scale > 0 ? view.width / scale : shown.size().norm();
    projection.look_at(center, camera.across_m.value_or(across));
  }
  Box everything = shown;
  if (scene.bounds.min.allFinite() && !scene.bounds.empty()) everything.extend(scene.bounds);
  if (view.layers.grid) everything.extend(grid_box(scene, projection, grid_pitch(projection)));
  const ZInterval of_mobile = heights_in(scene, frame.mobile);
  heights.min = std::min(heights.min, of_mobile.min);
  heights.max = std::max({heights.max, of_mobile.max, top_of_overlays(scene, frame)});
  for (const FrameBody& body : frame.mobile) {
    everything.extend(body.pose_world_body.position());
    heights.max = std::max(heights.max, body.pose_world_body.z + 1);
  }
  projection.reach(corners_of(everything, heights));
  return projection;
}

}  // namespace

bool is_from_above(const Camera& camera) {
  return !camera.perspective && camera.pitch == 0 && camera.yaw == 0;
}

struct Painter::Impl {
  FrameScene scene;
  SceneMeshes meshes{scene, {}};
  std::optional<Canvas> canvas;  // created with the first picture

  void set(FrameScene shown) {
    const KeepFpEnvironment keep;
    scene = std::move(shown);
    meshes.pieces.clear();
    for (const engine::FrameType& type : scene.types) meshes.pieces.push_back(pieces_of(type));
  }
};

namespace {

/// Appends the types that exist only in this frame, such as bodies with moved joints, to the types of the
/// scene. The destructor removes them.
class WithTypesOf {
 public:
  WithTypesOf(const Frame& frame, FrameScene& scene, std::vector<Pieces>& pieces)
      : scene_(scene), pieces_(pieces), own_(scene.types.size()) {
    for (const engine::FrameType& type : frame.types) {
      scene_.types.push_back(type);
      pieces_.push_back(pieces_of(type));
    }
  }
  ~WithTypesOf() {
    scene_.types.erase(scene_.types.begin() + static_cast<std::ptrdiff_t>(own_), scene_.types.end());
    pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(own_), pieces_.end());
  }
  WithTypesOf(const WithTypesOf&) = delete;
  WithTypesOf& operator=(const WithTypesOf&) = delete;

 private:
  FrameScene& scene_;
  std::vector<Pieces>& pieces_;
  std::size_t own_;
};

}  // namespace

Painter::Painter(FrameScene scene) : impl_(std::make_unique<Impl>()) { set_scene(std::move(scene)); }
Painter::~Painter() {
  const KeepFpEnvironment keep;
  impl_.reset();
}
Painter::Painter(Painter&&) noexcept = default;
Painter& Painter::operator=(Painter&&) noexcept = default;

const FrameScene& Painter::scene() const { return impl_->scene; }
void Painter::set_scene(FrameScene scene) { impl_->set(std::move(scene)); }

/// A picture before it is drawn: its layers in the order of drawing, its projection and its lettering.
struct Painter::Composition {
  std::vector<AnyLayer> layers;
  Projection projection;
  Writing writing;
};

Painter::Composition Painter::compose(const Frame& frame, const View& view) {
  const FrameScene& scene = impl_->scene;
  const Layers& shown = view.layers;
  const Theme& theme = theme_of(view.background);
  std::vector<Rgba> colors;  // empty: bodies have their own colours
  if (!frame.values.empty())
    colors = value_colors(frame.values, view.values.value_or(range_of(frame.values)));

  const Content content{impl_->meshes, frame, colors, shown, theme};

  std::vector<AnyLayer> layers;
  std::optional<Projection> projection;
  Framing framing = empty_framing(view);
  if (is_from_above(view.camera)) {
    framing = frame_from_above(scene, view);
    projection = Projection::from_above(framing);
    if (shown.grid) layers.emplace_back(flat(floor_grid(framing, theme.grid), true));
    const FixedBodies fixed = fixed_bodies(scene);
    add_flat_fixed(layers, content, fixed.of_floor, framing);
    // Drawn before the walls, which hide the ends of beams: a beam is drawn wider than the ray that was cast.
    add_in_air(layers, content, *projection, SolidLayer::Depth::floor);
    add_flat_fixed(layers, content, fixed.others, framing);
    add_on_floor(layers, content, *projection);
    add_flat_mobile(layers, content, framing);
  } else {
    projection = project(scene, frame, view, framing);
    std::vector<AnyLayer> on_floor;
    if (shown.grid)
      on_floor.emplace_back(solid_grid(scene, *projection, grid_pitch(*projection), theme.grid));
    add_on_floor(on_floor, content, *projection);
    std::vector<AnyLayer> in_air;
    add_in_air(in_air, content, *projection, SolidLayer::Depth::air);
    add_solids(layers, content, *projection, std::move(on_floor), std::move(in_air));
  }
  add_ties(layers, content, *projection);
  return {std::move(layers), *projection, written(scene, frame, *projection, framing, view)};
}

Picture Painter::draw(const Frame& frame, const View& view) {
  const KeepFpEnvironment keep;
  const WithTypesOf with_types(frame, impl_->scene, impl_->meshes.pieces);
  if (!impl_->canvas) impl_->canvas.emplace();
  impl_->canvas->check_size(view.width, view.height);
  Composition composition = compose(frame, view);
  const Theme& theme = theme_of(view.background);
  composition.layers.emplace_back(
      flat(mesh_of(composition.writing, composition.projection.stroke(), theme), true));
  return impl_->canvas->paint(composition.projection, theme.ground, composition.layers);
}

std::string Painter::draw_vector(const Frame& frame, const View& view, VectorFormat format,
                                 const FileTexts& texts) {
  if (!is_from_above(view.camera))
    throw std::runtime_error(
        "cannot draw this view as vector graphics: only views from straight above without perspective, with "
        "pitch and yaw 0, are possible; draw other views as pixels (.png)");
  if (view.width < 1 || view.height < 1)
    throw std::runtime_error(fmt::format(
        "cannot draw a picture of {} x {} pixels: each side must be at least 1", view.width, view.height));
  const KeepFpEnvironment keep;
  const WithTypesOf with_types(frame, impl_->scene, impl_->meshes.pieces);
  const Composition composition = compose(frame, view);
  const VectorDrawing drawing = vector_drawing(composition.projection, composition.layers,
                                               composition.writing, theme_of(view.background));
  FileTexts metadata = texts;
  for (auto& [key, value] : metadata) value = printable_utf8(value);
  return format == VectorFormat::svg ? svg_text(drawing, metadata) : pdf_text(drawing, metadata);
}

Picture draw(const FrameScene& scene, const Frame& frame, const View& view) {
  return Painter(scene).draw(frame, view);
}

}  // namespace troupe::render
