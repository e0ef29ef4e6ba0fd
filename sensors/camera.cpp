#include "sensors/camera.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/sensing/sight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <tuple>

namespace troupe::sensors {
namespace {

using engine::CommittedView;
using engine::DeviceKind;
using engine::Element;
using engine::OutlineChain;
using engine::SenseBatch;

constexpr Color k_sky{135 / 255.0f, 206 / 255.0f, 235 / 255.0f, 1};
constexpr Color k_floor{0.8f, 0.8f, 0.8f, 1};

struct Lens {
  struct Params {
    std::uint32_t width = 32;
    std::uint32_t height = 32;
    double range_near = 0.2;
    double range_far = 8;
    double fov_horizontal = radians(70);
    double fov_vertical = radians(40);
    double pan = 0;
    double tilt = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      constexpr double k_most_pixels = 4096;  // per edge
      constexpr double k_farthest = 1000;     // m
      constexpr double k_widest = troupe::radians(170);
      d.member<&Params::width>("width", within(1, k_most_pixels), "width of the image, pixels");
      d.member<&Params::height>("height", within(1, k_most_pixels), "height of the image, pixels");
      d.member<&Params::range_near>("range_near", meters, above(0), at_most(k_farthest),
                                    "surfaces nearer than this are not drawn");
      d.member<&Params::range_far>(
          "range_far", meters, above(0), at_most(k_farthest),
          "surfaces farther than this are drawn as sky; must be greater than range_near");
      d.member<&Params::fov_horizontal>("fov_horizontal", radians, above(0), at_most(k_widest),
                                        "angle from the left to the right edge of the picture");
      d.member<&Params::fov_vertical>("fov_vertical", radians, above(0), at_most(k_widest),
                                      "angle from the lower to the upper edge of the picture");
      d.member<&Params::pan>("pan", radians, within(-2 * k_pi, 2 * k_pi),
                             "angle from the camera's heading to the axis of view; positive: to the right");
      d.member<&Params::tilt>("tilt", radians, within(-k_pi / 2, k_pi / 2),
                              "angle of the axis of view above the horizontal; negative: downwards");
    }
  };

  static constexpr std::array reads{engine::k_shown_color};

  Params params;
  Pose pose_body_camera;   ///< pan included
  double half_width = 0;   ///< half the width of the image plane at a depth of 1 m, m
  double half_height = 0;  ///< half the height of the image plane at a depth of 1 m, m
  SinCos tilt;

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_sensor);
  Result<> bind_part(const engine::TypeSpec& type, std::uint32_t part);
  std::uint64_t sense(const SenseBatch& batch) const;

  /// Distance, m, of the middle of a column of pixels from the middle of the picture, positive to the right,
  /// in the image plane at a depth of 1 m.
  double right(double column) const { return half_width * ((column + 0.5) / params.width * 2 - 1); }
  /// Distance, m, of the middle of a row of pixels from the middle of the picture, positive upwards, in the
  /// image plane at a depth of 1 m.
  double up(double row) const { return half_height * (1 - (row + 0.5) / params.height * 2); }
  bool is_level() const { return tilt.sin == 0; }
};

/// A ray through a pixel. Its point at depth t (m along the axis of view) is the camera's position + t *
/// across in the plane, and t * rise above the camera.
struct PixelRay {
  Vec2 across;  ///< world frame
  double rise = 0;
};

/// One solid: the region inside its contours (even-odd rule), extruded over an interval of heights.
struct Region {
  BodyId body;
  std::uint32_t solid = 0;
  std::uint32_t part = 0;
  ZInterval z;          ///< heights relative to the camera
  bool around = false;  ///< whether the camera is straight above or below the solid
};

/// An edge of an outline, relative to the camera.
struct Edge {
  Vec2 from;
  Vec2 to;
  std::uint32_t region = 0;  ///< index of the region that it bounds
  std::size_t first = 0;     ///< first column of pixels in which it may be visible
  std::size_t last = 0;      ///< last column of pixels in which it may be visible
};

/// A crossing of a ray and an outline.
struct Crossing {
  std::uint32_t region = 0;
  double depth = 0;
  /// Whether the ray passes to the other side of the edge here, and so enters or leaves the region. If it
  /// does so through a corner, this is true for only one of the two edges.
  bool is_change = false;
  friend auto operator<=>(const Crossing&, const Crossing&) = default;
};

/// Renders the images of cameras. Each thread keeps one object of this class, which keeps its buffers, so
/// that only the first images allocate memory.
class Painter {
 public:
  /// Renders the image of a camera into its readings. own: the row, in the state tables, of the body that has
  /// the camera. mount: the frame in which the lens's pose is given. state, slot: the table of the readings,
  /// and the entry of this body.
  void paint(const CommittedView& view, const Lens& lens, Row own, const engine::Mount& mount,
             engine::StateTable& state, std::size_t slot) {
    lens_ = &lens;
    view_ = &view;
    origin_ = mount.transform * lens.pose_body_camera.position();
    height_ = mount.z + lens.pose_body_camera.z;
    forward_ = mount.transform.rotation * (Rotation(lens.pose_body_camera.heading) * Vec2::UnitX());
    color_ = state.cell<std::uint8_t>(slot, k_camera_color);
    depth_ = state.cell<float>(slot, k_camera_depth);
    gather(own);
    bound_columns();
    collect_edges();
    std::size_t next = 0;  // the first edge that is not visible in any column so far
    in_column_.clear();
    for (std::size_t column = 0; column < lens.params.width; ++column) {
      std::erase_if(in_column_, [&](std::uint32_t e) { return edges_[e].last < column; });
      for (; next < edges_.size() && edges_[next].first <= column; ++next)
        in_column_.push_back(static_cast<std::uint32_t>(next));
      if (lens.is_level())
        paint_column(column);
      else
        paint_pixels(column);
    }
  }

 private:
  PixelRay ray(double column, double row) const {
    const double up = lens_->up(row);
    const Vec2 right(forward_.y(), -forward_.x());
    return {(lens_->tilt.cos - up * lens_->tilt.sin) * forward_ + lens_->right(column) * right,
            lens_->tilt.sin + up * lens_->tilt.cos};
  }

  /// Collects the outlines that may be in the field of view, and the regions that they bound.
  void gather(Row own) {
    Box box;
    box.extend(origin_);
    for (const double column : {-0.5, static_cast<double>(lens_->params.width) - 0.5})
      for (const double row : {-0.5, static_cast<double>(lens_->params.height) - 0.5})
        box.extend(Vec2(origin_ + lens_->params.range_far * ray(column, row).across));
    chains_.clear();
    const auto any = [](const partition::BodyCircle&) { return true; };
    const auto keep = [this](const OutlineChain& chain) { chains_.push_back(chain); };
    engine::for_each_fixed_chain(*view_, box, any, keep);
    engine::for_each_body_chain(*view_, box, own, any, keep);
    add_fixed_around();
    // Removes duplicates: a long edge is visited once for each of its circles.
    const auto key = [](const OutlineChain& c) {
      return std::tuple(c.body, c.solid, c.ranger_return < 0, c.piece);
    };
    std::ranges::sort(chains_, {}, key);
    const auto same = [&](const OutlineChain& a, const OutlineChain& b) { return key(a) == key(b); };
    chains_.erase(std::unique(chains_.begin(), chains_.end(), same), chains_.end());

    regions_.clear();
    region_of_.clear();
    for (const OutlineChain& chain : chains_) {
      if (regions_.empty() || regions_.back().body != chain.body || regions_.back().solid != chain.solid)
        regions_.push_back({chain.body, chain.solid, chain.part, chain.z.shifted(-height_), false});
      region_of_.push_back(static_cast<std::uint32_t>(regions_.size() - 1));
    }
    for (std::size_t i = 0; i < chains_.size(); ++i) find_around(chains_[i], regions_[region_of_[i]]);
    around_.clear();
    for (std::uint32_t r = 0; r < regions_.size(); ++r)
      if (regions_[r].around) around_.push_back(r);
  }

  /// Computes leftmost_ and rightmost_. The margin of one pixel on each side is far above rounding errors.
  void bound_columns() {
    // A pixel of row `row` is right(column) to the right of the axis of view, seen from above, and `ahead`
    // along it. Over the rows, `ahead` is between its values at the upper and the lower edge of the picture.
    const auto ahead = [&](double row) { return lens_->tilt.cos - lens_->up(row) * lens_->tilt.sin; };
    const double top = ahead(-0.5);
    const double bottom = ahead(static_cast<double>(lens_->params.height) - 0.5);
    const double nearest = std::min(top, bottom);
    const double farthest = std::max(top, bottom);
    leftmost_.clear();
    rightmost_.clear();
    constexpr double k_least_ahead = 1e-3;  // below it, rays may point sideways or backwards
    if (nearest < k_least_ahead) return;
    for (std::size_t column = 0; column < lens_->params.width; ++column) {
      const double left = lens_->right(static_cast<double>(column) - 1);
      const double right = lens_->right(static_cast<double>(column) + 1);
      leftmost_.push_back(std::min(left / nearest, left / farthest));
      rightmost_.push_back(std::max(right / nearest, right / farthest));
    }
  }

  /// Collects the edges of all chains that may be visible, sorted by their first columns.
  void collect_edges() {
    edges_.clear();
    const std::size_t width = lens_->params.width;
    for (std::size_t i = 0; i < chains_.size(); ++i)
      engine::for_each_edge(chains_[i], [&](const Vec2& a, const Vec2& b) {
        Edge edge{a - origin_, b - origin_, region_of_[i], 0, width - 1};
        if (!leftmost_.empty() && !find_columns(edge)) return;
        edges_.push_back(edge);
      });
    std::ranges::sort(edges_, {}, &Edge::first);
  }

  /// Sets the columns in which an edge may be visible. Returns false if there are none. leftmost_ must not be
  /// empty: all rays point forward.
  bool find_columns(Edge& edge) const {
    const double ahead_from = edge.from.dot(forward_);
    const double ahead_to = edge.to.dot(forward_);
    if (ahead_from < 0 && ahead_to < 0) return false;
    if (ahead_from <= 0 || ahead_to <= 0) return true;  // it may be visible in any column
    const auto tangent = [&](const Vec2& at, double ahead) {
      return (at.x() * forward_.y() - at.y() * forward_.x()) / ahead;
    };
    const double one = tangent(edge.from, ahead_from);
    const double other = tangent(edge.to, ahead_to);
    const auto first = std::ranges::lower_bound(rightmost_, std::min(one, other));
    const auto end = std::ranges::upper_bound(leftmost_, std::max(one, other));
    edge.first = static_cast<std::size_t>(first - rightmost_.begin());
    edge.last = static_cast<std::size_t>(end - leftmost_.begin());
    return edge.first < edge.last--;
  }

  /// Adds a chain without vertices for each static solid that is straight above or below the camera. The
  /// other chains are not enough: if the outline of the solid is far away, none of them belongs to the solid.
  void add_fixed_around() {
    const partition::StaticScene& scene = view_->scene();
    scene.for_each_box_at(origin_, [&](std::uint32_t index) {
      const partition::FixedSolid& fixed = scene.solids()[index];
      // At the height of a solid, its top and underside are not visible.
      if (fixed.solid.z.contains(height_) || !contains(fixed.solid, origin_)) return;
      chains_.push_back({.vertices = {},
                         .z = fixed.solid.z,
                         .body = fixed.body,
                         .part = fixed.part,
                         .solid = index,
                         .piece = std::numeric_limits<std::uint32_t>::max(),
                         .ranger_return = fixed.ranger_return});
    });
  }

  /// Updates region.around for one of the chains (connected edges of the outline) of the region. For a body,
  /// the crossings of all its chains are counted, one chain per call. For static geometry, of which only some
  /// chains have been collected, only the chain from add_fixed_around() counts.
  void find_around(const OutlineChain& chain, Region& region) {
    if (!chain.closed) {
      region.around = region.around || chain.vertices.empty();
      return;
    }
    if (region.z.contains(0)) return;  // its top and underside are not visible
    engine::for_each_edge(chain, [&](const Vec2& a, const Vec2& b) {
      if (changes(a - origin_, b - origin_, forward_) && depth_of(a - origin_, b - origin_, forward_) > 0)
        region.around = !region.around;
    });
  }

  /// Whether the ends of an edge, relative to the camera, are on different sides of the line of a ray.
  /// across: the direction of the ray in the plane.
  static bool changes(const Vec2& a, const Vec2& b, const Vec2& across) {
    return (cross(a, across) < 0) != (cross(b, across) < 0);
  }
  /// The depth at which a ray crosses an edge, as a multiple of `across`. The ends of the edge must be on
  /// different sides of the ray, or on the ray.
  static double depth_of(const Vec2& a, const Vec2& b, const Vec2& across) {
    const double side_a = cross(a, across);
    const double side_b = cross(b, across);
    const double along_a = a.dot(across);
    const double along_b = b.dot(across);
    const double t = side_a == side_b ? 0.0 : side_a / (side_a - side_b);
    return (along_a + t * (along_b - along_a)) / across.squaredNorm();
  }

  /// Adds the crossing of a ray and an edge, if there is one within range_far.
  void meet(std::uint32_t region, const Vec2& a, const Vec2& b, const Vec2& across) {
    const double side_a = cross(a, across);
    const double side_b = cross(b, across);
    if (std::min(side_a, side_b) > 0 || std::max(side_a, side_b) < 0) return;
    const double depth = depth_of(a, b, across);
    if (depth < 0 || depth > lens_->params.range_far) return;
    crossings_.push_back({region, depth, (side_a < 0) != (side_b < 0)});
  }

  /// Finds the crossings of a ray with the edges that may be visible in the present column.
  void cross_all(const PixelRay& ray) {
    crossings_.clear();
    for (const std::uint32_t e : in_column_) meet(edges_[e].region, edges_[e].from, edges_[e].to, ray.across);
    std::ranges::sort(crossings_);
  }

  void paint_column(std::size_t column) {
    cross_all(ray(static_cast<double>(column), 0));
    for (std::size_t row = 0; row < lens_->params.height; ++row)
      paint_pixel(column, row, ray(static_cast<double>(column), static_cast<double>(row)));
  }
  void paint_pixels(std::size_t column) {
    for (std::size_t row = 0; row < lens_->params.height; ++row) {
      const PixelRay through = ray(static_cast<double>(column), static_cast<double>(row));
      cross_all(through);
      paint_pixel(column, row, through);
    }
  }

  void paint_pixel(std::size_t column, std::size_t row, const PixelRay& ray) {
    double nearest = lens_->params.range_far;
    const Region* seen = nullptr;
    bool is_floor = false;
    const auto offer = [&](double depth, const Region* region) {
      if (depth < lens_->params.range_near || depth > nearest ||
          (depth == nearest && (seen != nullptr || is_floor)))
        return;
      nearest = depth;
      seen = region;
      is_floor = region == nullptr;
    };
    // The ray meets only regions whose outlines it crosses, and regions above or below the camera.
    const Crossing* crossing = crossings_.data();
    const Crossing* end = crossing + crossings_.size();
    auto around = around_.begin();
    while (crossing != end || around != around_.end()) {
      const std::uint32_t r = around == around_.end() ? crossing->region
                              : crossing == end       ? *around
                                                      : std::min(*around, crossing->region);
      if (around != around_.end() && *around == r) ++around;
      const Region& region = regions_[r];
      const double level = region.z.max < 0 ? region.z.max : region.z.min > 0 ? region.z.min : 0;
      const double depth = level * ray.rise > 0 ? level / ray.rise : -1;  // depth of its top or underside
      bool is_over = region.around;
      for (; crossing != end && crossing->region == r; ++crossing) {
        if (region.z.contains(crossing->depth * ray.rise)) offer(crossing->depth, &region);
        if (crossing->is_change && crossing->depth < depth) is_over = !is_over;
      }
      if (depth > 0 && is_over) offer(depth, &region);
    }
    if (height_ > 0 && ray.rise < 0) offer(-height_ / ray.rise, nullptr);

    const std::size_t pixel = row * lens_->params.width + column;
    const engine::RayHit hit{.body = seen ? seen->body : BodyId(), .part = seen ? seen->part : 0};
    const Color color = seen != nullptr ? color_of(*view_, hit) : is_floor ? k_floor : k_sky;
    const std::array<float, 4> parts{color.r, color.g, color.b, color.a};
    for (std::size_t k = 0; k < parts.size(); ++k) color_[4 * pixel + k] = to_byte(parts[k]);
    depth_[pixel] = static_cast<float>(nearest);
  }

  const CommittedView* view_ = nullptr;
  const Lens* lens_ = nullptr;
  Vec2 origin_ = Vec2::Zero();     // world frame, m
  double height_ = 0;              // world frame, m
  Vec2 forward_ = Vec2::UnitX();   // world frame
  std::span<std::uint8_t> color_;  // image of the current camera
  std::span<float> depth_;
  std::vector<OutlineChain> chains_;
  std::vector<std::uint32_t> region_of_;  // per chain
  std::vector<Region> regions_;           // sorted by body and solid
  std::vector<std::uint32_t> around_;     // regions straight above or below the camera
  // Per column of pixels: bounds of the tangents of the bearings of its rays, to the right of the axis of
  // view, with a margin. Empty if rays may point sideways or backwards.
  std::vector<double> leftmost_;
  std::vector<double> rightmost_;
  std::vector<Edge> edges_;               // that may be visible, sorted by Edge::first
  std::vector<std::uint32_t> in_column_;  // indices of the edges that may be visible in the present column
  std::vector<Crossing> crossings_;       // of one ray, sorted by region and depth
};

DeviceKind::Prepared Lens::prepare(const Params& params, const Pose& pose_body_sensor) {
  const SinCos across = sincos(params.fov_horizontal / 2);
  const SinCos upright = sincos(params.fov_vertical / 2);
  const Lens lens{.params = params,
                  .pose_body_camera = compose(pose_body_sensor, {0, 0, 0, -params.pan}),
                  .half_width = across.sin / across.cos,
                  .half_height = upright.sin / upright.cos,
                  .tilt = sincos(params.tilt)};
  // The distance to the corners of the image at range_far. For a tilted camera this is an upper bound.
  const double farthest =
      params.range_far * sqrt(1 + lens.half_width * lens.half_width + lens.half_height * lens.half_height);
  const std::uint32_t pixels = params.width * params.height;
  return {.data = lens,
          .percepts = {{"color", Element::u8, 4 * pixels, "", "red, green, blue, opacity of each pixel"},
                       {"depth", Element::f32, pixels, "m", "depth of each pixel along the axis of view"}},
          .reach_m = pose_body_sensor.position().norm() + farthest,
          .watts = 100,  // as Stage's manual says
          .camera = engine::Camera{.width = params.width,
                                   .height = params.height,
                                   .range_far = params.range_far,
                                   .color = k_camera_color,
                                   .depth = k_camera_depth}};
}

/// Checks that range_near is below range_far.
Result<> Lens::bind_part(const engine::TypeSpec&, std::uint32_t) {
  if (params.range_near < params.range_far) return {};
  return Error{fmt::format("has a range_near of {} m, which must be below its range_far of {} m",
                           params.range_near, params.range_far)};
}

std::uint64_t Lens::sense(const SenseBatch& batch) const {
  thread_local const auto painter = std::make_unique<Painter>();
  for (std::size_t i = 0; i < batch.rows.size(); ++i)
    painter->paint(batch.committed, *this, batch.rows[i], batch.mount(i), batch.state, batch.slot(i));
  return batch.rows.size() * params.width * params.height;
}

}  // namespace

DeviceKind camera_kind() {
  return engine::make_device_kind<Lens>("camera", "renders colour and depth images of its field of view");
}

}  // namespace troupe::sensors
