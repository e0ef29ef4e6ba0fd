#include "render/vector_drawing.hpp"

#include "render/scene_layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace troupe::render {
namespace {

/// A path and its height above the floor, m.
struct Flat {
  double z = 0;
  VectorPath path;
};

/// Collects triangles and lines as paths. A triangle or line is joined to the previous path if both have the
/// same colour, width and height.
class Paths {
 public:
  Vec2 middle = Vec2::Zero();  ///< centre of the picture, pixels from its upper left corner
  std::vector<Flat> all;

  /// Adds a triangle. Its corners are in pixels right of and above the picture's centre; `z` is its height,
  /// m.
  void add_triangle(std::array<Vec2, 3> corners, double z, Rgba color) {
    for (Vec2& corner : corners) corner = placed(corner);
    Flat& flat = path_of(z, color, 0);
    Ring* const last = flat.path.rings.empty() ? nullptr : &flat.path.rings.back();
    if (last && last->size() >= 3 && last->front() == corners[0] && last->back() == corners[1])
      last->push_back(corners[2]);  // this is the next triangle of a fan
    else
      add_ring(flat, {corners.begin(), corners.end()});
  }

  /// Adds a line with square ends. `from`, `to` and `z` are as for add_triangle(); `width` is in pixels.
  void add_line(const Vec2& from, const Vec2& to, double width, double z, Rgba color) {
    const Vec2 a = placed(from);
    const Vec2 b = placed(to);
    Flat& flat = path_of(z, color, width);
    Ring* const last = flat.path.rings.empty() ? nullptr : &flat.path.rings.back();
    if (last && last->back() == a)
      last->push_back(b);
    else
      add_ring(flat, {a, b});
  }

  /// Ends the current path: later additions are not joined to it.
  void close() { is_open_ = false; }

 private:
  Vec2 placed(const Vec2& pixels) const { return {middle.x() + pixels.x(), middle.y() - pixels.y()}; }

  Flat& path_of(double z, Rgba color, double width) {
    if (!is_open_ || all.back().z != z || all.back().path.color != color || all.back().path.width != width)
      all.push_back({z, {{}, color, width, false}});
    is_open_ = true;
    return all.back();
  }

  /// Adds a ring to the path of `flat`. A transparent ring gets a path of its own, because in a common path
  /// the overlap of two rings would not be darker than the rings.
  void add_ring(Flat& flat, Ring ring) {
    if (flat.path.color[3] == 255 || flat.path.rings.empty()) {
      flat.path.rings.push_back(std::move(ring));
      return;
    }
    Flat next{flat.z, {{}, flat.path.color, flat.path.width, false}};
    next.path.rings.push_back(std::move(ring));
    all.push_back(std::move(next));
  }

  bool is_open_ = false;
};

Rgba color_of(const Vertex& v, const Instance& instance) {
  switch (v.paint) {
    case Paint::own: return v.own;
    case Paint::body: return instance.body;
    case Paint::edge: return instance.edge;
    case Paint::mark: break;
  }
  return instance.mark;
}

void add(Paths& paths, const Layer& layer) {
  for (const Instance& instance : layer.instances) {
    const auto place = [&](double x, double y) -> Vec2 {
      return {instance.x + instance.size * (x * instance.cos - y * instance.sin),
              instance.y + instance.size * (x * instance.sin + y * instance.cos)};
    };
    paths.close();
    for (std::size_t i = 0; i + 2 < layer.mesh.size(); i += 3) {
      const Vertex& a = layer.mesh[i];
      const Vertex& b = layer.mesh[i + 1];
      const Vertex& c = layer.mesh[i + 2];
      const double z = double{instance.z} + c.z;
      const Rgba color = color_of(c, instance);
      if (a.offset_x == 0 && a.offset_y == 0) {
        paths.add_triangle({place(a.x, a.y), place(b.x, b.y), place(c.x, c.y)}, z, color);
      } else {  // a stroke: two triangles, made by add_stroke()
        const double width = Vec2(c.offset_x - b.offset_x, c.offset_y - b.offset_y).norm();
        paths.add_line(place(a.x, a.y), place(b.x, b.y), width, z, color);
        i += 3;
      }
    }
  }
}

void add(Paths& paths, const SolidLayer& layer, const Projection& projection) {
  const auto pixels = [&](double x, double y, double z) -> Vec2 {
    return projection.to_pixels(projection.origin() + Vec3(x, y, z)).value_or(Vec2::Zero());
  };
  paths.close();
  for (std::size_t i = 0; i + 2 < layer.mesh.size(); i += 3) {
    const SolidVertex& a = layer.mesh[i];
    const SolidVertex& b = layer.mesh[i + 1];
    const SolidVertex& c = layer.mesh[i + 2];
    if (a.corner == Corner::stroke) {  // a stroke: two triangles, made by add_stroke()
      paths.add_line(pixels(a.x, a.y, a.z), pixels(a.ax, a.ay, a.az), 2 * std::abs(a.side), 0, a.own);
      i += 3;
    } else {
      paths.add_triangle({pixels(a.x, a.y, a.z), pixels(b.x, b.y, b.z), pixels(c.x, c.y, c.z)}, 0, c.own);
    }
  }
}

void add(Paths& paths, const PointLayer& layer) {
  const double half = layer.size / 2;
  for (const Point& point : layer.points) {
    paths.close();
    const Vec2 at(point.x, point.y);
    const std::array<Vec2, 4> corners = {at + Vec2(-half, -half), at + Vec2(half, -half),
                                         at + Vec2(half, half), at + Vec2(-half, half)};
    paths.add_triangle({corners[0], corners[1], corners[2]}, point.z, point.color);
    paths.add_triangle({corners[0], corners[2], corners[3]}, point.z, point.color);
  }
}

/// Marks the lines of a path as closed if all of them end at the point at which they begin.
void close_lines(VectorPath& path) {
  const auto comes_back = [](const Ring& ring) { return ring.size() > 3 && ring.front() == ring.back(); };
  if (path.width == 0 || !std::ranges::all_of(path.rings, comes_back)) return;
  for (Ring& ring : path.rings) ring.pop_back();
  path.is_closed = true;
}

/// Whether a text of a drawing may contain a character. It must not contain control characters, surrogates,
/// noncharacters (such as U+FFFF) or numbers above U+10FFFF, because XML or cairo refuses most of them.
bool is_printable(char32_t code) {
  const bool is_control = code < 0x20 || code == 0x7f;
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  const bool is_noncharacter = (code >= 0xfdd0 && code < 0xfdf0) || (code & 0xfffeU) == 0xfffeU;
  return !is_control && !is_surrogate && !is_noncharacter && code <= 0x10ffff;
}

}  // namespace

std::string printable_utf8(std::string_view text) {
  constexpr std::array<char32_t, 4> k_least{0, 0x80, 0x800, 0x10000};  // smaller ones are overlong forms
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t more = first < 0x80 ? 0 : first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
    bool is_right = (first < 0x80 || (first >= 0xc0 && first < 0xf8)) && i + more < text.size();
    char32_t code = more == 0 ? first : first & (0x3fU >> more);
    for (std::size_t k = 1; is_right && k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      is_right = (next & 0xc0U) == 0x80U;
      code = code << 6U | (next & 0x3fU);
    }
    is_right = is_right && code >= k_least[more] && is_printable(code);
    out += is_right ? text.substr(i, more + 1) : "?";
    i += is_right ? more + 1 : 1;
  }
  return out;
}

VectorDrawing vector_drawing(const Projection& projection, std::span<const AnyLayer> layers,
                             const Writing& writing, const Theme& theme) {
  VectorDrawing drawing{projection.width(), projection.height(), theme.ground, {}};
  Paths paths;
  paths.middle = Vec2(projection.width(), projection.height()) / 2;
  const auto flush = [&] {
    std::ranges::stable_sort(paths.all, {}, &Flat::z);
    for (Flat& flat : paths.all) {
      close_lines(flat.path);
      drawing.items.emplace_back(std::move(flat.path));
    }
    paths.all.clear();
    paths.close();
  };
  for (const AnyLayer& any : layers) {
    if (const auto* layer = std::get_if<Layer>(&any)) {
      if (layer->on_top) flush();
      add(paths, *layer);
    } else if (const auto* points = std::get_if<PointLayer>(&any)) {
      if (points->on_top) flush();
      add(paths, *points);
    } else {
      flush();
      add(paths, std::get<SolidLayer>(any), projection);
      // Not sorted by height: solid layers on the floor have no heights.
      std::vector<Flat> in_order = std::move(paths.all);
      paths.all.clear();
      for (Flat& flat : in_order) drawing.items.emplace_back(std::move(flat.path));
      paths.close();
    }
  }
  flush();
  add(paths, flat(writing.under, true));
  flush();
  const double stroke = projection.stroke();
  for (const double width : {k_halo_strokes, k_ink_strokes}) {
    const Rgba color = width == k_halo_strokes ? theme.halo : theme.ink;
    for (const auto& [a, b] : writing.lines) paths.add_line(a, b, width * stroke, 0, color);
    flush();
  }
  for (const Text& text : writing.texts)
    drawing.items.emplace_back(
        VectorText{.text = printable_utf8(text.text),
                   .pen = Vec2(paths.middle.x() + text.pen.x(), paths.middle.y() - text.pen.y()),
                   .ends_at_pen = text.ends_at_pen,
                   .cap_height = 6 * text.unit,
                   .color = theme.ink,
                   .halo = theme.halo,
                   .halo_width = 0.5 * (k_halo_strokes - k_ink_strokes) * stroke});
  return drawing;
}

}  // namespace troupe::render
