#include "render/solid_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace troupe::render {
namespace {

using Eigen::Vector3d;
using engine::FrameShape;
using engine::FrameType;

/// If the directions of two adjacent sides differ by less than this angle, rad, the sides count as one curved
/// surface without a line between them.
constexpr double k_bend = 30 * k_pi / 180;

SolidVertex vertex(const Vector3d& p, const Vector3d& a, double side, Paint paint, Rgba own, Corner corner) {
  return {static_cast<float>(p.x()),
          static_cast<float>(p.y()),
          static_cast<float>(p.z()),
          static_cast<float>(a.x()),
          static_cast<float>(a.y()),
          static_cast<float>(a.z()),
          static_cast<float>(side),
          own,
          paint,
          corner};
}

Vector3d at(const Vec2& p, double z) { return {p.x(), p.y(), z}; }

void add_quad(SolidMesh& mesh, const std::array<Vector3d, 4>& corners, const Vector3d& normal, Paint paint,
              Rgba own) {
  for (const std::size_t k : {0, 1, 2, 0, 2, 3})
    mesh.push_back(vertex(corners[k], normal, 0, paint, own, Corner::face));
}

/// Whether the vertical edge between two adjacent sides of a prism is drawn as a line. Both sides must be at
/// least `least_side` long, m, and their directions must differ by more than k_bend. `before` and `after` are
/// the vectors along the two sides, m.
bool is_edge(const Vec2& before, const Vec2& after, double least_side) {
  const double lengths = before.norm() * after.norm();
  return std::min(before.norm(), after.norm()) >= least_side &&
         before.dot(after) < std::cos(k_bend) * lengths;
}

void add_sides(SolidMesh& mesh, const Ring& ring, const ZInterval& z, Paint paint, Rgba own) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = ring[(i + 1) % ring.size()];
    const Vec2 way = b - a;
    if (way.norm() == 0) continue;
    const Vector3d normal(way.y() / way.norm(), -way.x() / way.norm(), 0);
    add_quad(mesh, {at(a, z.min), at(b, z.min), at(b, z.max), at(a, z.max)}, normal, paint, own);
  }
}

/// Whether a point (body frame, height `z`, m) is inside or on the surface of a shape of the type other than
/// shape number `own`. A line at such a point would be visible only where two surfaces nearly coincide.
bool is_inside_others(const FrameType& type, std::size_t own, const Vec2& point, double z) {
  constexpr double k_flush_m = 0.005;
  for (std::size_t s = 0; s < type.shapes.size(); ++s) {
    const Solid& other = type.shapes[s].solid;
    if (s != own && z >= other.z.min - k_flush_m && z <= other.z.max + k_flush_m && contains(other, point))
      return true;
  }
  return false;
}

void add_edges(SolidMesh& mesh, const FrameType& type, std::size_t shape, const SolidStyle& style,
               bool is_halo) {
  const Solid& solid = type.shapes[shape].solid;
  const auto& color = type.shapes[shape].color;
  const bool is_of_shape = color && style.halo == 0;  // not of a body: see MeshStyle::halo
  const Paint paint = is_of_shape || is_halo ? Paint::own : Paint::edge;
  const Rgba own = is_halo ? Rgba{255, 255, 255, 255} : is_of_shape ? darker(to_rgba(*color)) : Rgba{};
  const double width = is_halo ? style.halo : style.edge;
  const auto add = [&](const Vec2& a, double za, const Vec2& b, double zb) {
    if (!is_inside_others(type, shape, (a + b) / 2, (za + zb) / 2))
      add_stroke(mesh, at(a, za), at(b, zb), width, paint, own, is_halo ? Corner::rim : Corner::stroke);
  };
  for (const Ring& ring : solid.contours) {
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2& a = ring[i];
      const Vec2& b = ring[(i + 1) % n];
      add(a, solid.z.max, b, solid.z.max);
      add(a, solid.z.min, b, solid.z.min);
      if (is_edge(a - ring[(i + n - 1) % n], b - a, style.least_side)) add(a, solid.z.min, a, solid.z.max);
    }
  }
}

/// Draws lines along the outlines of the pieces of a top face, in the colour of the face. They cover cracks
/// between adjacent pieces, which occur where two pieces share a side but not its end points.
void close_cracks(SolidMesh& mesh, const FrameShape& shape, const std::vector<ConvexPrism>& pieces,
                  double width) {
  if (pieces.size() < 2) return;
  const Paint paint = shape.color ? Paint::own : Paint::body;
  const Rgba own = shape.color ? to_rgba(*shape.color) : Rgba{};
  for (const ConvexPrism& piece : pieces)
    for (std::size_t i = 0; i < piece.outline.size(); ++i)
      add_stroke(mesh, at(piece.outline[i], shape.solid.z.max),
                 at(piece.outline[(i + 1) % piece.outline.size()], shape.solid.z.max), width, paint, own);
}

/// A copy of the type that has only its highest shape, on top of which the heading mark is drawn.
FrameType topmost(const FrameType& type) {
  FrameType top{.mobile = type.mobile, .radius = type.radius};
  const auto highest =
      std::ranges::max_element(type.shapes, {}, [](const FrameShape& shape) { return shape.solid.z.max; });
  if (highest != type.shapes.end()) top.shapes.push_back(*highest);
  return top;
}

/// Adds the triangles of a flat mesh, as faces that point up (Corner::face) or as marks on such faces
/// (Corner::plain).
void add_flat(SolidMesh& mesh, std::span<const Vertex> triangles, Corner corner) {
  for (const Vertex& v : triangles) mesh.push_back({v.x, v.y, v.z, 0, 0, 1, 0, v.own, v.paint, corner});
}

}  // namespace

SolidMesh prism_mesh(const FrameType& type, const Pieces& pieces, const SolidStyle& style) {
  SolidMesh mesh;
  const Mesh tops = body_mesh(type, pieces, {});
  add_flat(mesh, tops, Corner::face);
  for (const FrameShape& shape : type.shapes) {
    const Rgba own = shape.color ? to_rgba(*shape.color) : Rgba{};
    for (const Ring& ring : shape.solid.contours)
      add_sides(mesh, ring, shape.solid.z, shape.color ? Paint::own : Paint::body, own);
  }
  for (std::size_t i = 0; i < type.shapes.size() && style.edge > 0; ++i) {
    close_cracks(mesh, type.shapes[i], pieces[i], 0.6 * style.edge);
    if (width_of(type.shapes[i].solid) < style.least_edged) continue;
    if (style.halo > 0) add_edges(mesh, type, i, style, true);
    add_edges(mesh, type, i, style, false);
  }
  if (style.mark) {
    const FrameType top = topmost(type);
    const Pieces of_top = pieces_of(top);
    const std::size_t without = body_mesh(top, of_top, {}).size();
    const Mesh marked = body_mesh(top, of_top, {.mark = true});
    add_flat(mesh, std::span(marked).subspan(without), Corner::plain);
  }
  return mesh;
}

ZInterval heights_of(const FrameType& type) {
  if (type.shapes.empty()) return {0, 0};
  ZInterval z{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const FrameShape& shape : type.shapes) {
    z.min = std::min(z.min, shape.solid.z.min);
    z.max = std::max(z.max, shape.solid.z.max);
  }
  return z;
}

SolidMesh box_mesh(const FrameType& type) {
  SolidMesh mesh;
  Box extent;
  for (const FrameShape& shape : type.shapes) {
    for (const Ring& ring : shape.solid.contours) {
      for (const Vec2& p : ring) extent.extend(p);
    }
  }
  if (extent.empty()) return mesh;
  const ZInterval z = heights_of(type);
  const Ring ring = {
      extent.min, {extent.max.x(), extent.min.y()}, extent.max, {extent.min.x(), extent.max.y()}};
  add_quad(mesh, {at(ring[0], z.max), at(ring[1], z.max), at(ring[2], z.max), at(ring[3], z.max)}, {0, 0, 1},
           Paint::body, {});
  add_sides(mesh, ring, z, Paint::body, {});
  return mesh;
}

SolidMesh shadow_mesh(const SolidMesh& mesh) {
  SolidMesh faces;
  for (const SolidVertex& v : mesh)
    if (v.corner == Corner::face) faces.push_back(v);
  return faces;
}

void add_stroke(SolidMesh& mesh, const Vector3d& a, const Vector3d& b, double width, Paint paint, Rgba own,
                Corner corner) {
  // The left side seen from b is the right side seen from a.
  const std::array corners = {
      vertex(a, b, width / 2, paint, own, corner), vertex(a, b, -width / 2, paint, own, corner),
      vertex(b, a, width / 2, paint, own, corner), vertex(b, a, -width / 2, paint, own, corner)};
  for (const std::size_t k : {0, 1, 2, 0, 2, 3}) mesh.push_back(corners[k]);
}

void add_plain(SolidMesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, Rgba own) {
  for (const Vector3d& p : {a, b, c})
    mesh.push_back(vertex(p, Vector3d::Zero(), 0, Paint::own, own, Corner::plain));
}

}  // namespace troupe::render
