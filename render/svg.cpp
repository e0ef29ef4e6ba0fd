#include "render/vector_drawing.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace troupe::render {
namespace {

/// Height of capitals per font size in Helvetica and similar fonts.
constexpr double k_cap_height_em = 0.72;

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  return out;
}

/// Rounds to a hundredth of a pixel and omits trailing zeros, to keep the file small.
std::string number(double x) {
  const double rounded = std::round(100 * x) / 100;
  return fmt::format("{:.6g}", rounded == 0 ? 0.0 : rounded);
}

std::string paint(const char* name, Rgba color) {
  std::string text = fmt::format(" {}=\"#{:02x}{:02x}{:02x}\"", name, color[0], color[1], color[2]);
  if (color[3] != 255) text += fmt::format(" {}-opacity=\"{:.3g}\"", name, color[3] / 255.0);
  return text;
}

void add(std::string& svg, const VectorPath& path) {
  svg += "<path d=\"";
  for (const Ring& ring : path.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i)
      svg += fmt::format("{}{} {}",
                         i == 0   ? "M"
                         : i == 1 ? "L"
                                  : " ",
                         number(ring[i].x()), number(ring[i].y()));
    if (path.width == 0 || path.is_closed) svg += "Z";
  }
  if (path.width == 0)
    svg += fmt::format("\"{}/>\n", paint("fill", path.color));
  else
    svg += fmt::format("\" fill=\"none\"{} stroke-width=\"{}\"/>\n", paint("stroke", path.color),
                       number(path.width));
}

void add(std::string& svg, const VectorText& text) {
  svg += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\"{}{}{} stroke-width=\"{}\">{}</text>\n",
                     number(text.pen.x()), number(text.pen.y()), number(text.cap_height / k_cap_height_em),
                     text.ends_at_pen ? " text-anchor=\"end\"" : "", paint("fill", text.color),
                     paint("stroke", text.halo), number(2 * text.halo_width), escaped(text.text));
}

}  // namespace

std::string svg_text(const VectorDrawing& drawing, const FileTexts& texts) {
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\" xml:space=\"preserve\">\n<desc>",
      drawing.width, drawing.height);
  for (std::size_t i = 0; i < texts.size(); ++i)
    svg += fmt::format("{}{}: {}", i == 0 ? "" : "\n", escaped(texts[i].first), escaped(texts[i].second));
  svg += "</desc>\n";
  if (drawing.ground[3] != 0)
    svg += fmt::format("<rect width=\"{}\" height=\"{}\"{}/>\n", drawing.width, drawing.height,
                       paint("fill", drawing.ground));
  // By default, SVG would draw several spaces as one; pixels and PDF do not. The paint-order "stroke" draws
  // the halo below the letters. The viewport clips everything outside the picture.
  svg +=
      "<g stroke-linecap=\"square\" stroke-linejoin=\"miter\" paint-order=\"stroke\" "
      "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n";
  for (const auto& item : drawing.items) std::visit([&](const auto& each) { add(svg, each); }, item);
  return svg + "</g>\n</svg>\n";
}

}  // namespace troupe::render
