#include "render/mesh.hpp"

#include <algorithm>
#include <cstddef>

namespace troupe::render {
namespace {

using engine::FrameShape;
using engine::FrameType;

constexpr Rgba k_white = {255, 255, 255, 255};
constexpr Rgba k_ink = {38, 36, 33, 255};

Vertex corner(const Vec2& p, double z, const Vec2& offset, Paint paint, Rgba own) {
  return {static_cast<float>(p.x()),
          static_cast<float>(p.y()),
          static_cast<float>(z),
          static_cast<float>(offset.x()),
          static_cast<float>(offset.y()),
          own,
          paint};
}

/// Adds a convex polygon as a triangle fan.
void add_convex(Mesh& mesh, const Ring& outline, double z, Paint paint, Rgba own) {
  for (std::size_t i = 2; i < outline.size(); ++i) {
    for (const std::size_t k : {std::size_t{0}, i - 1, i}) {
      mesh.push_back(corner(outline[k], z, Vec2::Zero(), paint, own));
    }
  }
}

void add_outlines(Mesh& mesh, const Solid& solid, double width, Paint paint, Rgba own) {
  for (const Ring& ring : solid.contours) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      add_stroke(mesh, ring[i], ring[(i + 1) % ring.size()], solid.z.max, width, paint, own);
    }
  }
}

/// The shapes of a type, sorted by the heights of their tops. The order of drawing determines how transparent
/// shapes blend, and which of two shapes of equal height covers the other.
std::vector<const FrameShape*> upwards(const FrameType& type) {
  std::vector<const FrameShape*> shapes;
  for (const FrameShape& shape : type.shapes) shapes.push_back(&shape);
  std::ranges::stable_sort(shapes, {}, [](const FrameShape* shape) { return shape->solid.z.max; });
  return shapes;
}

/// Adds the heading mark: a triangle at the front of the body, above all shapes, in a colour that contrasts
/// with the shape below the mark. If there is no shape below it, as between the paddles of a gripper, the
/// mark is at the front of the highest shape.
void add_mark(Mesh& mesh, std::span<const FrameShape* const> upwards) {
  Box extent;
  for (const FrameShape* shape : upwards) {
    for (const Ring& ring : shape->solid.contours) {
      for (const Vec2& p : ring) extent.extend(p);
    }
  }
  if (extent.empty()) return;
  const double length = extent.size().x();
  const double half_width = 0.26 * std::min(length, extent.size().y());
  const double y = extent.center().y();
  const double tip = extent.max.x() - 0.10 * length;
  const double base = tip - 1.3 * half_width;

  const FrameShape* below = nullptr;
  const Vec2 middle((tip + 2 * base) / 3, y);
  for (const FrameShape* shape : upwards)
    if (contains(shape->solid, middle)) below = shape;
  if (!below && upwards.size() > 1) return add_mark(mesh, upwards.last(1));
  const Paint paint = !below ? Paint::edge : below->color ? Paint::own : Paint::mark;
  const Rgba own = below && below->color ? contrasting(to_rgba(*below->color)) : Rgba{};
  add_convex(mesh, {{tip, y}, {base, y + half_width}, {base, y - half_width}}, upwards.back()->solid.z.max,
             paint, own);
}

}  // namespace

Rgba to_rgba(const Color& color) {
  return {to_byte(color.r), to_byte(color.g), to_byte(color.b), to_byte(color.a)};
}

Rgba darker(Rgba fill) {
  const auto shade = [](std::uint8_t v) { return static_cast<std::uint8_t>(v * 65 / 100); };
  return {shade(fill[0]), shade(fill[1]), shade(fill[2]), fill[3]};
}

Rgba contrasting(Rgba fill) {
  // Luma of ITU-R BT.601, in thousandths.
  const int luma = (299 * fill[0] + 587 * fill[1] + 114 * fill[2]) / 1000;
  return luma > 150 ? k_ink : k_white;
}

double width_of(const Solid& solid) {
  Box extent;
  for (const Ring& ring : solid.contours)
    for (const Vec2& p : ring) extent.extend(p);
  return extent.empty() ? 0 : extent.size().maxCoeff();
}

Pieces pieces_of(const FrameType& type) {
  Pieces pieces;
  for (const FrameShape& shape : type.shapes) pieces.push_back(convex_pieces(shape.solid));
  return pieces;
}

Mesh body_mesh(const FrameType& type, const Pieces& pieces, const MeshStyle& style) {
  Mesh mesh;
  const std::vector<const FrameShape*> shapes = upwards(type);
  double least_edged = 0;
  for (const FrameShape* shape : shapes) least_edged = std::max(least_edged, width_of(shape->solid));
  least_edged = std::min(least_edged, style.least_edged);
  for (const FrameShape* shape : shapes) {
    const Rgba own = shape->color ? to_rgba(*shape->color) : Rgba{};
    const Paint fill = shape->color ? Paint::own : Paint::body;
    const Paint edge = shape->color && style.halo == 0 ? Paint::own : Paint::edge;
    for (const ConvexPrism& piece : pieces[static_cast<std::size_t>(shape - type.shapes.data())]) {
      add_convex(mesh, piece.outline, shape->solid.z.max, fill, own);
    }
    if (width_of(shape->solid) < least_edged) continue;
    if (style.halo > 0) add_outlines(mesh, shape->solid, style.halo, Paint::own, k_white);
    if (style.edge > 0) add_outlines(mesh, shape->solid, style.edge, edge, darker(own));
  }
  if (style.mark) add_mark(mesh, shapes);
  return mesh;
}

Mesh silhouette(Mesh mesh) {
  std::erase_if(mesh, [](const Vertex& v) { return v.offset_x != 0 || v.offset_y != 0; });
  for (Vertex& v : mesh) v.paint = Paint::body;
  return mesh;
}

void add_stroke(Mesh& mesh, const Vec2& a, const Vec2& b, double z, double width, Paint paint, Rgba own) {
  const double length = (b - a).norm();
  const Vec2 along = length > 0 ? Vec2((b - a) * (0.5 * width / length)) : Vec2(0.5 * width, 0);
  const Vec2 across(-along.y(), along.x());
  const std::array corners = {
      corner(a, z, -along - across, paint, own), corner(b, z, along - across, paint, own),
      corner(b, z, along + across, paint, own), corner(a, z, across - along, paint, own)};
  for (const std::size_t k : {0, 1, 2, 0, 2, 3}) mesh.push_back(corners[k]);
}

void add_rectangle(Mesh& mesh, const Vec2& min, const Vec2& max, Rgba own) {
  add_convex(mesh, {min, {max.x(), min.y()}, max, {min.x(), max.y()}}, 0, Paint::own, own);
}

}  // namespace troupe::render
