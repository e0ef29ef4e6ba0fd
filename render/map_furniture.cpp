#include "render/map_furniture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

namespace troupe::render {
namespace {

constexpr Rgba k_grid_line = {233, 227, 214, 255};
constexpr Rgba k_ink = {92, 86, 75, 255};
constexpr Rgba k_halo = {250, 247, 240, 230};

constexpr double k_grid_pitch = 48;      // at least, strokes
constexpr double k_cap_height = 11;      // of the lettering, strokes
constexpr double k_margin = 14;          // of the furniture from the picture's edges, strokes
constexpr double k_longest_scale = 150;  // strokes

/// Lettering drawn as lines: only what lengths and times need. Each glyph is its polylines on a grid 4 wide
/// and 6 high, a point as its two digits.
std::string_view glyph(char c) {
  switch (c) {
    case '0': return "10 30 41 45 36 16 05 01 10";
    case '1': return "05 26 20, 10 30";
    case '2': return "05 16 36 45 44 00 40";
    case '3': return "05 16 36 45 44 33 42 41 30 10 01, 13 33";
    case '4': return "30 36 02 42";
    case '5': return "46 06 04 34 43 41 30 10 01";
    case '6': return "45 36 16 05 01 10 30 41 42 33 13 02";
    case '7': return "06 46 10";
    case '8': return "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33";
    case '9': return "01 10 30 41 45 36 16 05 04 13 33 44";
    case '.': return "10 10";
    case 'k': return "00 06, 02 34, 13 30";
    case 'm': return "00 04, 03 14 24 23 20, 23 34 44 43 40";
    case 's': return "43 34 14 03 12 32 41 30 10 01";
    default: return "";
  }
}

double advance(char c) { return c == '.' || c == ' ' ? 3 : 6; }

double text_width(std::string_view text) {
  double width = 0;
  for (const char c : text) width += advance(c);
  return width - 2;
}

/// Lines to draw, in pixels: the furniture is drawn twice, as its own halo and in ink.
using Lines = std::vector<std::pair<Vec2, Vec2>>;

void add_text(Lines& lines, std::string_view text, Vec2 pen, double unit) {
  for (const char c : text) {
    const std::string_view points = glyph(c);
    const auto at = [&](std::size_t i) {
      return Vec2(pen + unit * Vec2(points[i] - '0', points[i + 1] - '0'));
    };
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
      if (points[i + 2] == ',') {
        ++i;  // the polyline ends here
      } else {
        lines.emplace_back(at(i), at(i + 3));
      }
    }
    pen.x() += unit * advance(c);
  }
}

}  // namespace

RoundLength RoundLength::at_most(double metres) {
  // A length as long as 10^k but for rounding may come out as 5 * 10^(k-1): no harm.
  const int exponent = static_cast<int>(std::floor(std::log10(metres)));
  const double power = std::pow(10.0, exponent);
  const double steps = metres / power;
  return {(steps >= 5 ? 5 : steps >= 2 ? 2 : 1) * power, exponent};
}

std::string RoundLength::text() const {
  if (exponent >= 3) return fmt::format("{:.0f} km", metres / 1000);
  if (exponent <= -3) return fmt::format("{:.{}f} mm", metres * 1000, -3 - exponent);
  return fmt::format("{:.{}f} m", metres, exponent < 0 ? -exponent : 0);
}

Mesh floor_grid(const Framing& framing) {
  Mesh mesh;
  const double at_least = k_grid_pitch * framing.stroke / framing.pixels_per_metre;
  const double pitch = RoundLength::at_most(2.5 * at_least).metres;  // 1, 2, 5: steps of at most 2.5
  const Box world = framing.world();
  const double width = std::round(framing.stroke);
  const Vec2 half = Vec2(framing.width, framing.height) / 2;
  // Lines begin at whole pixels: none is blurred, all look alike.
  const auto line = [&](int axis, double coordinate) {
    Vec2 min = -half;
    Vec2 max = half;
    const double pixel = framing.pixels_per_metre * (coordinate - framing.center[axis]);
    min[axis] = std::round(pixel + half[axis] - width / 2) - half[axis];
    max[axis] = min[axis] + width;
    add_rectangle(mesh, min, max, k_grid_line);
  };
  for (const int axis : {0, 1}) {
    const double first = std::ceil(world.min[axis] / pitch);
    const int count = static_cast<int>(std::floor(world.max[axis] / pitch) - first) + 1;
    for (int i = 0; i < count; ++i) line(axis, (first + i) * pitch);
  }
  return mesh;
}

Mesh scale_and_time(const Framing& framing, double time_s) {
  Mesh mesh;
  if (!framing.has_furniture()) return mesh;
  const double stroke = framing.stroke;
  const double unit = stroke * k_cap_height / 6;
  const Vec2 half = Vec2(framing.width, framing.height) / 2;
  const double baseline = std::round(k_margin * stroke - half.y());
  const double middle = baseline + 3 * unit;

  Lines lines;
  const double longest = std::min(k_longest_scale * stroke, framing.width / 4.0);
  const RoundLength scale = RoundLength::at_most(longest / framing.pixels_per_metre);
  const double left = std::round(k_margin * stroke - half.x());
  const double right = left + scale.metres * framing.pixels_per_metre;
  lines.emplace_back(Vec2(left, middle), Vec2(right, middle));
  for (const double x : {left, right})
    lines.emplace_back(Vec2(x, middle - 2 * unit), Vec2(x, middle + 2 * unit));
  add_text(lines, scale.text(), {right + 5 * unit, baseline}, unit);

  const std::string time = fmt::format("{:.1f} s", time_s);
  add_text(lines, time, {half.x() - k_margin * stroke - unit * text_width(time), baseline}, unit);

  for (const auto& [a, b] : lines) add_stroke(mesh, a, b, 0, 5 * stroke, Paint::own, k_halo);
  for (const auto& [a, b] : lines) add_stroke(mesh, a, b, 0, 1.4 * stroke, Paint::own, k_ink);
  return mesh;
}

}  // namespace troupe::render
