#include "render/canvas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

namespace troupe::render {
namespace {

/// How far shadows reach on the floor for each metre of height.
constexpr double k_shadow_slope = 0.5;
/// Light comes from the left, from behind, and from above.
constexpr double k_light_x = -0.894;
constexpr double k_light_y = 0.447;
/// Clip depths that flat layers take up: they are spread over less than all of it, so that none is cut off.
constexpr double k_flat_depths = 0.9;

/// A point in the clip coordinates of OpenGL: what is seen has x, y and z from -w to w.
struct Clip {
  double x = 0, y = 0, z = 0, w = 1;

  Clip mixed(const Clip& other, double share) const {
    return {x + share * (other.x - x), y + share * (other.y - y), z + share * (other.z - z),
            w + share * (other.w - w)};
  }
};

/// The interval of heights that the depth buffer has to tell apart in flat layers.
ZInterval heights_of(std::span<const AnyLayer> layers) {
  ZInterval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const AnyLayer& any : layers) {
    if (const auto* points = std::get_if<PointLayer>(&any); points && points->on_map) {
      for (const Point& point : points->points) {
        all.min = std::min<double>(all.min, point.z);
        all.max = std::max<double>(all.max, point.z);
      }
    }
    const auto* layer = std::get_if<Layer>(&any);
    if (!layer || layer->mesh.empty() || layer->instances.empty()) continue;
    const auto [low, high] = std::ranges::minmax_element(layer->mesh, {}, &Vertex::z);
    const auto [bottom, top] = std::ranges::minmax_element(layer->instances, {}, &Instance::z);
    all.min = std::min<double>(all.min, low->z + bottom->z);
    all.max = std::max<double>(all.max, high->z + top->z);
  }
  return all.min < all.max ? all : ZInterval{all.min, all.min + 1};
}

template <class AnyInstance>
Rgba color_of(Paint paint, Rgba own, const AnyInstance& instance) {
  switch (paint) {
    case Paint::own: return own;
    case Paint::body: return instance.body;
    case Paint::edge: return instance.edge;
    case Paint::mark: break;
  }
  return instance.mark;
}

/// Puts the triangles of layers onto the picture.
class Projector {
 public:
  Projector(const Projection& projection, const ZInterval& heights, Raster& raster)
      : raster_(raster),
        width_(projection.width()),
        height_(projection.height()),
        heights_(heights),
        in_world_(projection.clip_matrix()),
        eye_(projection.viewer_from_origin()),
        nearest_(projection.nearest()),
        bias_(projection.clip_bias()) {}

  void operator()(const Layer& layer) {
    if (layer.on_top) raster_.clear_depth();
    for (const Instance& instance : layer.instances) {
      const auto place = [&](const Vertex& v) {
        const double x = double{v.x} * instance.size + v.offset_x;
        const double y = double{v.y} * instance.size + v.offset_y;
        return on_map(instance.x + x * instance.cos - y * instance.sin,
                      instance.y + x * instance.sin + y * instance.cos, double{instance.z} + v.z);
      };
      for (std::size_t i = 0; i + 2 < layer.mesh.size(); i += 3) {
        const Vertex& last = layer.mesh[i + 2];
        add({place(layer.mesh[i]), place(layer.mesh[i + 1]), place(last)},
            color_of(last.paint, last.own, instance), DepthRule::test_and_write);
      }
    }
  }

  void operator()(const SolidLayer& layer) {
    const DepthRule rule = layer.depth == SolidLayer::Depth::solid ? DepthRule::test_and_write
                           : layer.depth == SolidLayer::Depth::air ? DepthRule::test
                                                                   : DepthRule::none;
    for (const SolidInstance& instance : layer.instances)
      for (std::size_t i = 0; i + 2 < layer.mesh.size(); i += 3)
        add_solid(std::span(layer.mesh).subspan(i).first<3>(), instance, layer.shadow, rule);
  }

  void operator()(const PointLayer& layer) {
    if (layer.on_top) raster_.clear_depth();
    for (const Point& point : layer.points) {
      const Clip at =
          layer.on_map ? on_map(point.x, point.y, point.z) : in_world({point.x, point.y, point.z});
      if (is_inside(at)) raster_.add_square(pixel(at), layer.size, point.color, DepthRule::test_and_write);
    }
  }

 private:
  /// Of a point in pixels right of and above the picture's middle, and its height.
  Clip on_map(double x, double y, double z) const {
    const double share = (z - heights_.min) / (heights_.max - heights_.min);
    return {2 * x / width_, 2 * y / height_, k_flat_depths * (1 - 2 * share), 1};
  }

  Clip in_world(const Vec3& p) const {
    const auto& m = in_world_;
    return {m[0] * p.x() + m[4] * p.y() + m[8] * p.z() + m[12],
            m[1] * p.x() + m[5] * p.y() + m[9] * p.z() + m[13],
            m[2] * p.x() + m[6] * p.y() + m[10] * p.z() + m[14],
            m[3] * p.x() + m[7] * p.y() + m[11] * p.z() + m[15]};
  }

  static Vec3 turned(const SolidInstance& instance, double x, double y, double z) {
    return {x * instance.cos - y * instance.sin, x * instance.sin + y * instance.cos, z};
  }

  static Vec3 placed(const SolidInstance& instance, double x, double y, double z) {
    return turned(instance, x * instance.scale, y * instance.scale, z * instance.scale) +
           Vec3(instance.x, instance.y, instance.z);
  }

  /// Where the viewer sees a point of an instance, or its shadow on the floor.
  Clip seen(const SolidInstance& instance, double x, double y, double z, bool is_shadow) const {
    Vec3 p = placed(instance, x, y, z);
    if (is_shadow) {
      const double reach = k_shadow_slope * std::max(p.z(), 0.0);
      p = {p.x() - k_light_x * reach, p.y() - k_light_y * reach, 0};
    }
    return in_world(p);
  }

  /// A corner of a stroke: to the side of a line that is cut off where it comes too near.
  Clip stroke_corner(const SolidVertex& v, Clip here, Clip there) const {
    if (here.w < nearest_ && there.w > nearest_)
      here = here.mixed(there, (nearest_ - here.w) / (there.w - here.w));
    if (there.w < nearest_ && here.w > nearest_)
      there = there.mixed(here, (nearest_ - there.w) / (here.w - there.w));
    Vec2 along((there.x / there.w - here.x / here.w) * width_,
               (there.y / there.w - here.y / here.w) * height_);
    const double length = along.norm();
    along = length > 0 ? Vec2(along / length) : Vec2(1, 0);
    const Vec2 pixels = Vec2(-along.y(), along.x()) * v.side - along * std::abs(v.side);
    return {here.x + pixels.x() * 2 / width_ * here.w, here.y + pixels.y() * 2 / height_ * here.w,
            here.z + (v.corner == Corner::rim ? 0.5 * bias_ : bias_), here.w};
  }

  void add_solid(std::span<const SolidVertex, 3> corners, const SolidInstance& instance, bool is_shadow,
                 DepthRule rule) {
    const SolidVertex& last = corners[2];
    std::array<Clip, 3> clip;
    for (std::size_t i = 0; i < 3; ++i) {
      const SolidVertex& v = corners[i];
      clip[i] = seen(instance, v.x, v.y, v.z, is_shadow);
      if (v.corner == Corner::plain) clip[i].z += bias_;
      if (v.corner != Corner::stroke && v.corner != Corner::rim) continue;
      const Clip there = seen(instance, v.ax, v.ay, v.az, is_shadow);
      if (clip[i].w <= nearest_ && there.w <= nearest_) return;
      clip[i] = stroke_corner(v, clip[i], there);
    }
    Rgba color = color_of(last.paint, last.own, instance);
    if (last.corner == Corner::face) color = lit(color, last, instance);
    add(clip, is_shadow ? instance.edge : color, rule);
  }

  /// Faces are lit from both sides alike, as if turned to the viewer: contours wind any way.
  Rgba lit(Rgba color, const SolidVertex& v, const SolidInstance& instance) const {
    Vec3 normal = turned(instance, v.ax, v.ay, v.az);
    if (normal.dot(eye_ - placed(instance, v.x, v.y, v.z)) < 0) normal = -normal;
    const double side = 0.70 + 0.20 * (normal.x() * k_light_x + normal.y() * k_light_y);
    const double light = side + (1 - side) * std::max(normal.z(), 0.0);
    for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<std::uint8_t>(color[k] * light + 0.5);
    return color;
  }

  PixelPoint pixel(const Clip& at) const {
    return {0.5 * (at.x / at.w + 1) * width_, 0.5 * (1 - at.y / at.w) * height_, 0.5 * (at.z / at.w + 1)};
  }

  /// How far points of the clip coordinates may lie beyond the picture's sides, times w.
  double guard(double size) const { return Raster::k_guard / size; }

  bool is_inside(const Clip& at) const {
    return at.w > 0 && std::abs(at.z) <= at.w && std::abs(at.x) <= guard(width_) * at.w &&
           std::abs(at.y) <= guard(height_) * at.w;
  }

  void add(const std::array<Clip, 3>& corners, Rgba color, DepthRule rule) {
    if (std::ranges::all_of(corners, [this](const Clip& at) { return is_inside(at); })) {
      raster_.add_triangle({pixel(corners[0]), pixel(corners[1]), pixel(corners[2])}, color, rule);
      return;
    }
    const std::vector<Clip> kept = clipped(corners);
    if (!std::ranges::all_of(kept, [this](const Clip& at) { return at.w > 0 && std::isfinite(at.x / at.w); }))
      return;
    for (std::size_t i = 2; i < kept.size(); ++i)
      raster_.add_triangle({pixel(kept[0]), pixel(kept[i - 1]), pixel(kept[i])}, color, rule);
  }

  /// The part of a triangle that is_inside(), a convex polygon: Sutherland and Hodgman, Reentrant polygon
  /// clipping, Communications of the ACM 17 (1974).
  std::vector<Clip> clipped(const std::array<Clip, 3>& corners) const {
    const double wide = 0.999 * guard(width_);  // that what is rounded still lies inside
    const double high = 0.999 * guard(height_);
    const std::array<double (*)(const Clip&, double, double), 6> sides = {
        [](const Clip& p, double, double) { return p.z + p.w; },
        [](const Clip& p, double, double) { return p.w - p.z; },
        [](const Clip& p, double x, double) { return x * p.w - p.x; },
        [](const Clip& p, double x, double) { return x * p.w + p.x; },
        [](const Clip& p, double, double y) { return y * p.w - p.y; },
        [](const Clip& p, double, double y) { return y * p.w + p.y; }};
    std::vector<Clip> kept(corners.begin(), corners.end());
    for (const auto& side : sides) {
      std::vector<Clip> next;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        const Clip& a = kept[i];
        const Clip& b = kept[(i + 1) % kept.size()];
        const double at_a = side(a, wide, high);
        const double at_b = side(b, wide, high);
        if (at_a >= 0) next.push_back(a);
        if ((at_a >= 0) != (at_b >= 0)) next.push_back(a.mixed(b, at_a / (at_a - at_b)));
      }
      kept = std::move(next);
    }
    return kept;
  }

  Raster& raster_;
  double width_;
  double height_;
  ZInterval heights_;
  std::array<float, 16> in_world_;
  Vec3 eye_;
  double nearest_;
  double bias_;
};

}  // namespace

void Canvas::check_size(int width, int height) {
  if (width >= 1 && height >= 1 && width <= k_longest_side && height <= k_longest_side) return;
  throw std::runtime_error(
      fmt::format("cannot draw a picture of {} x {} pixels: each side must be from 1 to {}", width, height,
                  k_longest_side));
}

Picture Canvas::paint(const Projection& projection, Rgba ground, std::span<const AnyLayer> layers) {
  check_size(projection.width(), projection.height());
  raster_.begin(projection.width(), projection.height(), ground);
  Projector project(projection, heights_of(layers), raster_);
  for (const AnyLayer& layer : layers) std::visit(project, layer);
  return {projection.width(), projection.height(), raster_.finish()};
}

}  // namespace troupe::render
