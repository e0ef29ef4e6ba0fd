#include "render/overlays.hpp"

#include "render/map_furniture.hpp"
#include "render/solid_mesh.hpp"
#include "render/value_colors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace troupe::render {
namespace {

using engine::Frame;
using engine::FrameBody;
using engine::FrameScan;
using engine::FrameScene;
using engine::FrameTie;
using engine::FrameTransducer;

constexpr Rgba k_sight = {196, 30, 110, 200};
constexpr Rgba k_covered = {122, 168, 140, 255};
constexpr Rgba k_free_beam = {52, 140, 70, 255};
constexpr Rgba k_broken_beam = {206, 48, 40, 255};
// Opacities are from 0 to 255. Up to k_few_scans scans have the opacity k_scan_opacity. If there are more
// scans, their opacity is lower, but at least k_least_opacity, so that the scans do not hide the scene.
constexpr double k_scan_opacity = 46;
constexpr double k_few_scans = 20;
constexpr double k_least_opacity = 5;
constexpr std::uint8_t k_beam_opacity = 110;
constexpr std::uint8_t k_heat_opacity = 150;
constexpr std::uint8_t k_blob_opacity = 90;
// Opacity of squares that robots visited long ago (stale), and of squares with a robot (fresh).
constexpr double k_stale_opacity = 70, k_fresh_opacity = 150;

constexpr double k_grid_strokes = 48;      // least distance between grid lines, strokes
constexpr double k_most_grid_lines = 120;  // greatest number of grid lines in each direction
// Grid lines on each side of a point outside of the world's bounds that is in the middle of the picture. At
// the least distance between them, they fill a width of 1440 strokes.
constexpr double k_lines_around = 15;
constexpr double k_density_strokes = 36;  // least edge of a square of the layer `density`, strokes
constexpr std::size_t k_fan_steps = 8;    // triangles that show a single beam with an opening angle

/// A layer with one instance of a mesh that is in metres relative to Projection::origin().
SolidLayer in_world(SolidMesh mesh, SolidLayer::Depth depth) {
  return {std::move(mesh), {{0, 0, 0, 1, 1, 0, {}, {}, {}}}, depth};
}

Rgba with_opacity(Rgba color, std::uint8_t opacity) { return {color[0], color[1], color[2], opacity}; }

std::uint8_t scan_opacity(const Frame& frame) {
  const double crowd = std::max(1.0, static_cast<double>(frame.scans.size()) / k_few_scans);
  return static_cast<std::uint8_t>(std::max(k_least_opacity, k_scan_opacity / std::sqrt(crowd)));
}

/// End point of beam `i` of a transducer, relative to the world point `origin`, m. pose_world: pose of the
/// transducer. range: reading of the beam, m.
Vec3 end_of_beam(const Pose& pose_world, const FrameTransducer& transducer, std::size_t i, double range,
                 const Vec3& origin) {
  const double bearing = transducer.samples > 1
                             ? -transducer.fov / 2 + static_cast<double>(i) * transducer.fov /
                                                         static_cast<double>(transducer.samples - 1)
                             : 0;
  const Vec2 way = Rotation(pose_world.heading + bearing) * Vec2(range, 0);
  return Vec3(pose_world.x + way.x(), pose_world.y + way.y(), pose_world.z) - origin;
}

/// Adds a sector of a circle, which shows a single beam with the opening angle `fov`, rad. pose_world: pose
/// of the transducer. range: reading of the beam, m. origin: world point to which the mesh is relative, m.
void add_slice(SolidMesh& mesh, const Pose& pose_world, double fov, double range, const Vec3& origin,
               Rgba color) {
  const Vec3 middle = Vec3(pose_world.x, pose_world.y, pose_world.z) - origin;
  const FrameTransducer fan{.fov = fov, .samples = k_fan_steps + 1};
  for (std::size_t i = 0; i < k_fan_steps; ++i)
    add_plain(mesh, middle, end_of_beam(pose_world, fan, i, range, origin),
              end_of_beam(pose_world, fan, i + 1, range, origin), color);
}

void add_scan(SolidMesh& fills, SolidMesh& lines, const Content& content, const FrameScan& scan,
              const Projection& projection) {
  const Frame& frame = content.frame;
  const Layers& shown = content.layers;
  const Vec3& origin = projection.origin();
  const Rgba color = content.color_of(scan.body);
  const Rgba fill = with_opacity(color, scan_opacity(frame));
  const Pose pose_world_mount = compose(frame.mobile[scan.body].pose_world_body, scan.moved);
  for (const FrameTransducer& transducer : content.scene().rangers[scan.ranger].transducers) {
    const Pose pose = compose(pose_world_mount, transducer.pose_body);
    const Vec3 from = Vec3(pose.x, pose.y, pose.z) - origin;
    const float* const ranges = frame.ranges.data() + scan.first + transducer.first;
    if (shown.scans && transducer.samples == 1)
      add_slice(fills, pose, transducer.fov, ranges[0], origin, fill);
    for (std::size_t i = 0; i < transducer.samples; ++i) {
      const Vec3 end = end_of_beam(pose, transducer, i, ranges[i], origin);
      if (shown.scans && i > 0)
        add_plain(fills, from, end_of_beam(pose, transducer, i - 1, ranges[i - 1], origin), end, fill);
      if (shown.beams)
        add_stroke(lines, from, end, 0.8 * projection.stroke(), Paint::own,
                   with_opacity(color, k_beam_opacity));
    }
  }
}

/// The number of robots in each square of the floor that contains any. The keys are the x and y indices of
/// the square in a grid with edges of `pitch`, m.
std::map<std::pair<std::int64_t, std::int64_t>, int> count_in_squares(const FrameScene& scene,
                                                                      const Frame& frame, double pitch) {
  std::map<std::pair<std::int64_t, std::int64_t>, int> counts;
  for (const FrameBody& body : frame.mobile) {
    if (!scene.types[body.type].mobile) continue;
    const double x = std::floor(body.pose_world_body.x / pitch);
    const double y = std::floor(body.pose_world_body.y / pitch);
    if (std::abs(x) > 1e15 || std::abs(y) > 1e15) continue;
    ++counts[{static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)}];
  }
  return counts;
}

void add_square(SolidMesh& mesh, const Vec3& corner, double edge, Rgba color) {
  const Vec3 across = corner + Vec3(edge, edge, 0);
  add_plain(mesh, corner, corner + Vec3(edge, 0, 0), across, color);
  add_plain(mesh, corner, across, corner + Vec3(0, edge, 0), color);
}

/// Squares that robots have visited. A square whose last visit was longer ago is paler.
SolidLayer covered_squares(const Frame& frame, const Projection& projection) {
  SolidMesh mesh;
  for (const engine::FrameSquare& square : frame.covered) {
    const double opacity = k_stale_opacity + square.freshness * (k_fresh_opacity - k_stale_opacity);
    add_square(mesh, Vec3(square.x * frame.covered_m, square.y * frame.covered_m, 0) - projection.origin(),
               frame.covered_m, with_opacity(k_covered, static_cast<std::uint8_t>(opacity)));
  }
  return in_world(std::move(mesh), SolidLayer::Depth::floor);
}

/// The squares of the floor that contain robots, with edges of `pitch`, m. If `filled` is true, the colour of
/// a square shows its number of robots; else squares have lines of the colour `outline` around them.
SolidLayer squares(const FrameScene& scene, const Frame& frame, const Projection& projection, double pitch,
                   bool filled, Rgba outline) {
  SolidMesh mesh;
  const auto counts = count_in_squares(scene, frame, pitch);
  int most = 1;
  for (const auto& [square, count] : counts) most = std::max(most, count);
  for (const auto& [square, count] : counts) {
    const Vec3 a =
        Vec3(static_cast<double>(square.first) * pitch, static_cast<double>(square.second) * pitch, 0) -
        projection.origin();
    if (filled) {
      add_square(mesh, a, pitch,
                 with_opacity(value_color(most > 1 ? (count - 1.0) / (most - 1.0) : 0.5), k_heat_opacity));
    } else {
      const std::array<Vec3, 4> corners = {a, a + Vec3(pitch, 0, 0), a + Vec3(pitch, pitch, 0),
                                           a + Vec3(0, pitch, 0)};
      for (std::size_t i = 0; i < 4; ++i)
        add_stroke(mesh, corners[i], corners[(i + 1) % 4], projection.stroke(), Paint::own, outline);
    }
  }
  return in_world(std::move(mesh), SolidLayer::Depth::floor);
}

/// Adds the outlines of a body's shapes on the floor.
void add_footprint(SolidMesh& mesh, const FrameScene& scene, const FrameBody& body,
                   const Projection& projection, Rgba color) {
  const Transform place(body.pose_world_body);
  for (const engine::FrameShape& shape : scene.types[body.type].shapes) {
    for (const Ring& ring : shape.solid.contours) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2 a = place * ring[i];
        const Vec2 b = place * ring[(i + 1) % ring.size()];
        add_stroke(mesh, Vec3(a.x(), a.y(), 0) - projection.origin(),
                   Vec3(b.x(), b.y(), 0) - projection.origin(), projection.stroke(), Paint::own, color);
      }
    }
  }
}

/// Adds the trail of a body. Older parts are paler.
void add_trail(SolidMesh& mesh, const engine::FrameTrail& trail, const Projection& projection, Rgba color) {
  const std::size_t n = trail.points.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double age = static_cast<double>(n - 1 - i) / static_cast<double>(n);
    add_stroke(mesh, trail.points[i - 1] - projection.origin(), trail.points[i] - projection.origin(),
               1.4 * projection.stroke(), Paint::own,
               with_opacity(color, static_cast<std::uint8_t>(200 - 170 * age)));
  }
}

void add_names(Writing& writing, const FrameScene& scene, const Frame& frame, const Projection& projection) {
  const double unit = 0.75 * projection.stroke() * k_cap_height / 6;
  const Vec2 half = Vec2(projection.width(), projection.height()) / 2;
  for (std::size_t i = 0; i < frame.names.size(); ++i) {
    const FrameBody& body = frame.mobile[i];
    const ZInterval z = heights_of(scene.types[body.type]);
    const Vec3 top(body.pose_world_body.x, body.pose_world_body.y, body.pose_world_body.z + z.max);
    const auto place = projection.to_pixels(top);
    if (!place || (place->cwiseAbs().array() > half.array()).any()) continue;
    const double radius = scene.types[body.type].radius * projection.pixels_per_metre(top);
    writing.texts.push_back({frame.names[i], *place + Vec2(radius + 2 * unit, -3 * unit), unit, false});
  }
}

/// Adds a bar above each body with a power pack. The bar is green, or red if the charge is low.
void add_charges(Mesh& mesh, const FrameScene& scene, const Frame& frame, const Projection& projection) {
  constexpr double k_least_width = 10, k_height = 3;  // strokes
  constexpr double k_little = 0.2;  // fraction of the capacity below which the charge is low
  constexpr Rgba k_rim = {60, 56, 50, 255}, k_none = {235, 232, 225, 255};
  constexpr Rgba k_full = {52, 140, 70, 255}, k_low = {206, 48, 40, 255};
  const double stroke = projection.stroke();
  for (std::size_t i = 0; i < frame.charges.size(); ++i) {
    if (std::isnan(frame.charges[i])) continue;
    const FrameBody& body = frame.mobile[i];
    const double radius = scene.types[body.type].radius;
    const Vec3 top(body.pose_world_body.x, body.pose_world_body.y,
                   body.pose_world_body.z + heights_of(scene.types[body.type]).max);
    const auto place = projection.to_pixels(top);
    if (!place) continue;
    const double half = std::max(k_least_width * stroke / 2, radius * projection.pixels_per_metre(top));
    const double bottom = place->y() + radius * projection.pixels_per_metre(top) + 3 * stroke;
    const double share = std::clamp(frame.charges[i], 0.0, 1.0);
    const Vec2 low(place->x() - half, bottom);
    const Vec2 high(place->x() + half, bottom + k_height * stroke);
    add_rectangle(mesh, low - Vec2(stroke, stroke), high + Vec2(stroke, stroke), k_rim);
    add_rectangle(mesh, low, high, k_none);
    add_rectangle(mesh, low, {low.x() + 2 * half * share, high.y()}, share < k_little ? k_low : k_full);
  }
}

std::string number_text(double value) { return fmt::format("{:.4g}", value); }

/// The upper left corner of the legends, pixels from the picture's centre.
Vec2 legend_corner(const Framing& framing) {
  const double margin = k_furniture_margin * framing.stroke;
  return {margin - framing.width / 2.0, framing.height / 2.0 - margin};
}

/// Adds a bar of the colour scale with the values at its ends, in the upper left corner.
void add_color_bar(Writing& writing, const Frame& frame, const Framing& framing,
                   const std::pair<double, double>& range) {
  constexpr double k_width = 160, k_height = 10;  // strokes
  constexpr int k_steps = 40;
  const double stroke = framing.stroke;
  const double unit = stroke * k_cap_height / 6;
  const Vec2 corner = legend_corner(framing);
  const double top = corner.y() - 10 * unit;
  const double bottom = top - k_height * stroke;
  const double right = corner.x() + k_width * stroke;
  for (int i = 0; i < k_steps; ++i)
    add_rectangle(writing.under, {corner.x() + k_width * stroke * i / k_steps, bottom},
                  {corner.x() + k_width * stroke * (i + 1) / k_steps, top}, value_color((i + 0.5) / k_steps));
  writing.texts.push_back({frame.value_name, {corner.x(), corner.y() - 6 * unit}, unit, false});
  const double below = bottom - 9 * unit;
  writing.texts.push_back({number_text(range.first), {corner.x(), below}, unit, false});
  writing.texts.push_back({number_text(range.second), {right, below}, unit, true});
}

/// An entry of the legend of types: the robots of one type and colour, and their number.
struct Look {
  std::uint32_t type = 0;
  Rgba color{};
  std::size_t count = 0;
};

/// Adds a legend in the upper left corner: for each type and colour of robots a swatch, the name of the type
/// and the number of robots. It ends above the scale bar, if necessary with the words "and more".
void add_types(Writing& writing, const FrameScene& scene, const Frame& frame, const Framing& framing) {
  constexpr std::size_t k_most = 12;
  constexpr std::size_t k_most_looks = 10 * k_most;  // limits the time of the search
  std::vector<Look> looks;
  for (const FrameBody& body : frame.mobile) {
    const Rgba color = to_rgba(body.color);
    if (!scene.types[body.type].mobile) continue;
    // Types are compared by name, because a body with moved joints has a copy of its type.
    const auto known = std::ranges::find_if(looks, [&](const Look& look) {
      return look.color == color && scene.types[look.type].name == scene.types[body.type].name;
    });
    if (known != looks.end())
      ++known->count;
    else if (looks.size() < k_most_looks)
      looks.push_back({body.type, color, 1});
  }
  const double unit = framing.stroke * k_cap_height / 6;
  const double line = 11 * unit;
  Vec2 corner = legend_corner(framing);
  const double height = 2 * corner.y() - 12 * unit;  // from the upper margin to the texts at the lower edge
  const std::size_t most = std::clamp<std::size_t>(static_cast<std::size_t>(height / line), 1, k_most);
  for (std::size_t i = 0; i < looks.size() && i < most; ++i) {
    const Vec2 low(corner.x(), corner.y() - 6 * unit);
    const Vec2 high(corner.x() + 6 * unit, corner.y());
    const Vec2 text = low + Vec2(10 * unit, 0);
    if (i + 1 == most && looks.size() > most) {
      writing.texts.push_back({"and more", text, unit, false});
      break;
    }
    add_rectangle(writing.under, low - Vec2(0.5 * unit, 0.5 * unit), high + Vec2(0.5 * unit, 0.5 * unit),
                  darker(looks[i].color));
    add_rectangle(writing.under, low, high, looks[i].color);
    writing.texts.push_back(
        {fmt::format("{} ({})", scene.types[looks[i].type].name, looks[i].count), text, unit, false});
    corner.y() -= line;
  }
}

/// Adds the bounds of the world as lines on the floor.
void add_bounds(SolidMesh& mesh, const Box& bounds, const Projection& projection, Rgba color) {
  const std::array<Vec2, 4> corners = {bounds.min, Vec2(bounds.max.x(), bounds.min.y()), bounds.max,
                                       Vec2(bounds.min.x(), bounds.max.y())};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2& a = corners[i];
    const Vec2& b = corners[(i + 1) % 4];
    add_stroke(mesh, Vec3(a.x(), a.y(), 0) - projection.origin(), Vec3(b.x(), b.y(), 0) - projection.origin(),
               1.6 * projection.stroke(), Paint::own, color);
  }
}

}  // namespace

double grid_pitch(const Projection& projection) {
  const double scale = projection.pixels_per_metre(projection.floor_center());
  const double at_least = scale > 0 ? k_grid_strokes * projection.stroke() / scale : 1;
  return RoundLength::at_most(2.5 * at_least).metres;
}

Box grid_box(const FrameScene& scene, const Projection& projection, double pitch) {
  const Vec3 center = projection.floor_center();
  const Vec2 middle(center.x(), center.y());
  Box shown = scene.bounds;
  // In a level view, the floor's centre is below the eye, and not in the picture.
  if (projection.pixels_per_metre(center) > 0 && !shown.contains(middle))
    shown.extend(Box::around(middle, k_lines_around * pitch));
  const Box near = Box::around(middle, 0.5 * k_most_grid_lines * pitch);
  shown = {shown.min.cwiseMax(near.min), shown.max.cwiseMin(near.max)};
  return shown.empty() ? Box::around(middle, 5 * pitch) : shown;
}

SolidLayer solid_grid(const FrameScene& scene, const Projection& projection, double pitch, Rgba color) {
  SolidMesh mesh;
  const Vec3& origin = projection.origin();
  const Box shown = grid_box(scene, projection, pitch);
  const Vec2 first = pitch * (shown.min / pitch).array().floor().matrix();
  const Vec2 last = pitch * (shown.max / pitch).array().ceil().matrix();
  for (const int axis : {0, 1}) {
    const int count = static_cast<int>(std::lround((last[axis] - first[axis]) / pitch)) + 1;
    for (int i = 0; i < count; ++i) {
      Vec2 a = first;
      Vec2 b = last;
      a[axis] = b[axis] = first[axis] + i * pitch;
      add_stroke(mesh, Vec3(a.x(), a.y(), 0) - origin, Vec3(b.x(), b.y(), 0) - origin, projection.stroke(),
                 Paint::own, color);
    }
  }
  return in_world(std::move(mesh), SolidLayer::Depth::floor);
}

void add_on_floor(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection) {
  const FrameScene& scene = content.scene();
  const Frame& frame = content.frame;
  const Layers& shown = content.layers;
  if (shown.coverage && !frame.covered.empty()) layers.emplace_back(covered_squares(frame, projection));
  if (shown.density) {
    const double scale = projection.pixels_per_metre(projection.floor_center());
    const double at_least = scale > 0 ? k_density_strokes * projection.stroke() / scale : 1;
    layers.emplace_back(
        squares(scene, frame, projection, RoundLength::at_most(2.5 * at_least).metres, true, {}));
  }
  if (shown.tiles && scene.tile_m > 0)
    layers.emplace_back(squares(scene, frame, projection, scene.tile_m, true, {}));
  if (shown.cells && scene.cell_m > 0)
    layers.emplace_back(squares(scene, frame, projection, scene.cell_m, false, content.theme.square));
  SolidMesh lines;
  if (shown.bounds && scene.limits) add_bounds(lines, *scene.limits, projection, content.theme.line);
  if (shown.footprints) {
    for (std::size_t i = 0; i < frame.mobile.size(); ++i)
      add_footprint(lines, scene, frame.mobile[i], projection, darker(content.color_of(i)));
  }
  if (shown.trails) {
    for (const engine::FrameTrail& trail : frame.trails)
      add_trail(lines, trail, projection, content.color_of(trail.body));
  }
  if (!lines.empty()) layers.emplace_back(in_world(std::move(lines), SolidLayer::Depth::floor));
}

void add_in_air(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection,
                SolidLayer::Depth depth) {
  const Frame& frame = content.frame;
  const Layers& shown = content.layers;
  SolidMesh fills;
  SolidMesh lines;
  if (shown.scans || shown.beams) {
    for (const FrameScan& scan : frame.scans) add_scan(fills, lines, content, scan, projection);
  }
  if (shown.sights) {
    for (const engine::FrameSight& sight : frame.sights)
      add_stroke(lines, sight.from - projection.origin(), sight.to - projection.origin(),
                 1.2 * projection.stroke(), Paint::own, k_sight);
  }
  if (shown.blobs) {
    for (const engine::FrameBlob& blob : frame.blobs) {
      const Rgba color = to_rgba(blob.color);
      const Vec3 from = blob.from - projection.origin();
      const Vec3 right = blob.right - projection.origin();
      const Vec3 left = blob.left - projection.origin();
      add_plain(fills, from, right, left, with_opacity(color, k_blob_opacity));
      add_stroke(lines, right, left, 2.5 * projection.stroke(), Paint::own, color);
    }
  }
  if (!fills.empty()) layers.emplace_back(in_world(std::move(fills), depth));
  if (!lines.empty()) layers.emplace_back(in_world(std::move(lines), depth));
}

void add_ties(std::vector<AnyLayer>& layers, const Content& content, const Projection& projection) {
  SolidMesh lines;
  const auto add = [&](const std::vector<FrameTie>& ties) {
    for (const FrameTie& tie : ties) {
      const bool is_light = tie.kind == FrameTie::Kind::beam || tie.kind == FrameTie::Kind::broken_beam;
      const Rgba color = !is_light                          ? content.theme.line
                         : tie.kind == FrameTie::Kind::beam ? k_free_beam
                                                            : k_broken_beam;
      add_stroke(lines, tie.from - projection.origin(), tie.to - projection.origin(),
                 (is_light ? 1.6 : 2.4) * projection.stroke(), Paint::own, color);
    }
  };
  if (content.layers.links) add(content.frame.links);
  if (content.layers.grips) add(content.frame.grips);
  if (!lines.empty()) layers.emplace_back(in_world(std::move(lines), SolidLayer::Depth::floor));
}

Writing written(const FrameScene& scene, const Frame& frame, const Projection& projection,
                const Framing& framing, const View& view) {
  const bool from_above = is_from_above(view.camera);
  Furniture shown;
  shown.scale = view.layers.scale && from_above;
  if (view.layers.scale && view.layers.grid && !from_above)
    shown.left = fmt::format("grid {}", RoundLength::at_most(1.0001 * grid_pitch(projection)).text());
  if (view.layers.clock)
    shown.right = clock_text(frame.time_s, view.layers.speed ? frame.times_real_time : 0);
  Writing writing;
  if (view.layers.energy) add_charges(writing.under, scene, frame, projection);
  if (view.layers.names) add_names(writing, scene, frame, projection);
  if (framing.has_furniture()) {
    if (view.layers.legend && !frame.values.empty())
      add_color_bar(writing, frame, framing, view.values.value_or(range_of(frame.values)));
    else if (view.layers.types)
      add_types(writing, scene, frame, framing);
  }
  add_furniture(writing, framing, shown);
  return writing;
}

}  // namespace troupe::render
