#include "render/draw.hpp"

#include "base/assert.hpp"
#include "render/canvas.hpp"
#include "render/framing.hpp"
#include "render/map_furniture.hpp"
#include "render/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace troupe::render {
namespace {

using engine::Frame;
using engine::FrameBody;
using engine::FrameScene;
using engine::FrameType;

constexpr Rgba k_paper = {250, 247, 240, 255};
constexpr Rgba k_shadow = {226, 220, 207, 255};
constexpr Rgba k_stalled_edge = {224, 32, 32, 255};

constexpr double k_rows_of_one_stroke = 900;  // a picture of so many rows has strokes of one pixel
constexpr double k_margin = 0.03;             // around the scene's bounds, of the picture's smaller side
constexpr double k_furniture_band = 40;       // below the scene's bounds, strokes

/// A robot is drawn at least this wide, strokes: a swarm stays visible in a large world.
constexpr double k_smallest_robot = 3.5;
/// Robots narrower than this, strokes, are plain dots: an outline would hide their colour.
constexpr double k_smallest_outlined = 7;
/// Robots narrower than this, strokes, have no heading mark: it would be a speck.
constexpr double k_smallest_marked = 9;

/// Keeps what the driver does to rounding and denormals from the calling thread.
class KeepFpEnvironment {
 public:
  KeepFpEnvironment() { std::fegetenv(&environment_); }
  ~KeepFpEnvironment() { std::fesetenv(&environment_); }
  KeepFpEnvironment(const KeepFpEnvironment&) = delete;
  KeepFpEnvironment& operator=(const KeepFpEnvironment&) = delete;

 private:
  std::fenv_t environment_;
};

Framing frame_view(const FrameScene& scene, const View& view) {
  Framing framing{view.width, view.height};
  const double smaller = std::min(view.width, view.height);
  framing.stroke = std::max(1.0, smaller / k_rows_of_one_stroke);

  Box shown = view.region.value_or(scene.bounds);
  double margin = 0;
  double band = 0;  // more margin below
  if (view.region) {
    if (!shown.min.allFinite() || !shown.max.allFinite() || !((shown.size().array() > 0).all())) {
      throw std::runtime_error("cannot draw: the region of the view must be finite and of positive size");
    }
  } else {
    if (shown.empty()) shown = Box::around(Vec2::Zero(), 5);  // an empty world has a floor
    if ((shown.size().array() <= 0).any()) shown = shown.expanded(0.5);
    margin = k_margin * smaller;
    if (framing.has_furniture()) band = std::max(0.0, k_furniture_band * framing.stroke - margin);
  }
  const double wide = view.width - 2 * margin;
  const double high = view.height - 2 * margin - band;
  framing.pixels_per_metre = std::min(wide / shown.size().x(), high / shown.size().y());
  framing.center = shown.center() - Vec2(0, 0.5 * band / framing.pixels_per_metre);
  return framing;
}

/// Bodies by type, without those that lie outside the picture.
std::vector<std::vector<Instance>> instances_by_type(const FrameScene& scene,
                                                     const std::vector<FrameBody>& bodies,
                                                     const Framing& framing, double smallest) {
  std::vector<double> scales;  // of each type: how much its bodies are enlarged
  for (const FrameType& type : scene.types) {
    const double across = 2 * type.radius * framing.pixels_per_metre;
    scales.push_back(across > 0 && across < smallest ? smallest / across : 1.0);
  }
  const Box world = framing.world();
  std::vector<std::vector<Instance>> instances(scene.types.size());
  for (const FrameBody& body : bodies) {
    TROUPE_ASSERT(body.type < scene.types.size());
    const double scale = scales[body.type];
    const Vec2 position = body.pose_world_body.position();
    const double reach =
        scene.types[body.type].radius * scale + 2 * framing.stroke / framing.pixels_per_metre;
    if (!Box::around(position, reach).touches(world)) continue;
    const Vec2 place = framing.to_pixels(position);
    const SinCos heading = sincos(body.pose_world_body.heading);
    const Rgba color = to_rgba(body.color);
    instances[body.type].push_back({static_cast<float>(place.x()), static_cast<float>(place.y()),
                                    static_cast<float>(heading.cos), static_cast<float>(heading.sin),
                                    static_cast<float>(body.pose_world_body.z),
                                    static_cast<float>(scale * framing.pixels_per_metre), color,
                                    body.stalled ? k_stalled_edge : darker(color), contrasting(color)});
  }
  return instances;
}

/// What lies flat on the picture rather than in the world.
Layer flat(Mesh mesh, bool on_top) { return {std::move(mesh), {{0, 0, 1, 0, 0, 1, {}, {}, {}}}, on_top}; }

/// The floor plan and whatever else never moves, with a shadow on the floor that lifts it off the paper.
void add_fixed(std::vector<Layer>& layers, const FrameScene& scene, const Framing& framing) {
  const auto by_type = instances_by_type(scene, scene.fixed, framing, 0);
  std::vector<Layer> shadows;
  std::vector<Layer> bodies;
  for (std::size_t type = 0; type < by_type.size(); ++type) {
    if (by_type[type].empty()) continue;
    const MeshStyle style{static_cast<float>(framing.stroke), false};
    bodies.push_back({body_mesh(scene.types[type], style), by_type[type], bodies.empty()});
    shadows.push_back({silhouette(bodies.back().mesh), by_type[type], shadows.empty()});
    for (Instance& instance : shadows.back().instances) {
      instance.x += static_cast<float>(2 * framing.stroke);
      instance.y -= static_cast<float>(2 * framing.stroke);
      instance.body = k_shadow;
    }
  }
  std::ranges::move(shadows, std::back_inserter(layers));
  std::ranges::move(bodies, std::back_inserter(layers));
}

void add_mobile(std::vector<Layer>& layers, const FrameScene& scene, const Frame& frame,
                const Framing& framing) {
  const auto by_type = instances_by_type(scene, frame.mobile, framing, k_smallest_robot * framing.stroke);
  bool first = true;
  for (std::size_t type = 0; type < by_type.size(); ++type) {
    if (by_type[type].empty()) continue;
    const double across = 2 * scene.types[type].radius * framing.pixels_per_metre / framing.stroke;
    MeshStyle style;
    if (across >= k_smallest_outlined) {
      style.edge = static_cast<float>(framing.stroke * std::clamp(0.08 * across, 0.8, 1.6));
    }
    style.mark = scene.types[type].mobile && across >= k_smallest_marked;
    // Robots lie on top of the floor plan at any height: a map that hides its robots is of no use.
    layers.push_back({body_mesh(scene.types[type], style), by_type[type], std::exchange(first, false)});
  }
}

}  // namespace

Picture draw(const FrameScene& scene, const Frame& frame, const View& view) {
  const KeepFpEnvironment keep;
  const Framing framing = frame_view(scene, view);
  std::vector<Layer> layers;
  layers.push_back(flat(floor_grid(framing), true));
  add_fixed(layers, scene, framing);
  if (frame.types.empty()) {
    add_mobile(layers, scene, frame, framing);
  } else {
    FrameScene all{.types = scene.types};
    all.types.insert(all.types.end(), frame.types.begin(), frame.types.end());
    add_mobile(layers, all, frame, framing);
  }
  layers.push_back(flat(scale_and_time(framing, frame.time_s), true));
  return paint(view.width, view.height, k_paper, layers);
}

}  // namespace troupe::render
