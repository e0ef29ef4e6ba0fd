#include "render/map_furniture.hpp"

#include <fmt/format.h>

#include <cmath>

namespace troupe::render {
namespace {

constexpr double k_grid_pitch = 48;      // least distance of grid lines, strokes
constexpr double k_longest_scale = 150;  // greatest length of the scale bar, strokes

}  // namespace

RoundLength RoundLength::at_most(double metres) {
  // Because of rounding, the result for exactly 10^k may be 5 * 10^(k-1), which is harmless.
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

Mesh floor_grid(const Framing& framing, Rgba color) {
  Mesh mesh;
  const double at_least = k_grid_pitch * framing.stroke / framing.pixels_per_metre;
  // Neighbours in the lengths 1, 2, 5, 10, ... differ by a factor of at most 2.5, so the result is at least
  // at_least.
  const double pitch = RoundLength::at_most(2.5 * at_least).metres;
  const Box world = framing.world();
  const double width = std::round(framing.stroke);
  const Vec2 half = Vec2(framing.width, framing.height) / 2;
  // Lines begin at whole pixels, so that no line is blurred and all lines look alike.
  const auto line = [&](int axis, double coordinate) {
    Vec2 min = -half;
    Vec2 max = half;
    const double pixel = framing.pixels_per_metre * (coordinate - framing.center[axis]);
    min[axis] = std::round(pixel + half[axis] - width / 2) - half[axis];
    max[axis] = min[axis] + width;
    add_rectangle(mesh, min, max, color);
  };
  for (const int axis : {0, 1}) {
    const double first = std::ceil(world.min[axis] / pitch);
    const int count = static_cast<int>(std::floor(world.max[axis] / pitch) - first) + 1;
    for (int i = 0; i < count; ++i) line(axis, (first + i) * pitch);
  }
  return mesh;
}

std::string clock_text(double time_s, double times_real_time) {
  std::string text = fmt::format("{:.1f} s", time_s);
  if (times_real_time >= 999.5)  // three digits would need an exponent
    text += fmt::format("  {:.0f} x real time", times_real_time);
  else if (times_real_time > 0)
    text += fmt::format("  {:.3g} x real time", times_real_time);
  return text;
}

void add_furniture(Writing& writing, const Framing& framing, const Furniture& shown) {
  if (!framing.has_furniture()) return;
  const double stroke = framing.stroke;
  const double unit = stroke * k_cap_height / 6;
  const Vec2 half = Vec2(framing.width, framing.height) / 2;
  const double baseline = std::round(k_furniture_margin * stroke - half.y());
  const double left = std::round(k_furniture_margin * stroke - half.x());
  double pen = left;

  Lines& lines = writing.lines;
  const auto add_words = [&](const std::string& text, double x, bool ends_at_pen) {
    if (!text.empty()) writing.texts.push_back({text, {x, baseline}, unit, ends_at_pen});
  };
  if (shown.scale) {
    const double middle = baseline + 3 * unit;
    const double longest = std::min(k_longest_scale * stroke, framing.width / 4.0);
    const RoundLength scale = RoundLength::at_most(longest / framing.pixels_per_metre);
    const double right = left + scale.metres * framing.pixels_per_metre;
    lines.emplace_back(Vec2(left, middle), Vec2(right, middle));
    for (const double x : {left, right})
      lines.emplace_back(Vec2(x, middle - 2 * unit), Vec2(x, middle + 2 * unit));
    add_words(scale.text(), right + 5 * unit, false);
    pen = right + 5 * unit + text_width(scale.text(), unit) + 8 * unit;
  }
  add_words(shown.left, pen, false);
  add_words(shown.right, half.x() - k_furniture_margin * stroke, true);
}

}  // namespace troupe::render
