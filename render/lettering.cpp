#include "render/lettering.hpp"

namespace troupe::render {
namespace {

/// A character: its polylines, and `advance`, the distance from its left end to that of the next character.
/// Both are in multiples of the parameter `unit` of add_text().
struct Glyph {
  /// Polylines, separated by commas. A point has two characters, x from 0 to 4 and y from 0 (baseline) to 6.
  /// The letters "a" and "b" for y mean 1 and 2 below the baseline.
  std::string_view points;
  double advance = 6;
};

// clang-format off
Glyph glyph(char c) {
  switch (c) {
    case '0': return {"10 30 41 45 36 16 05 01 10"};
    case '1': return {"05 26 20, 10 30"};
    case '2': return {"05 16 36 45 44 00 40"};
    case '3': return {"05 16 36 45 44 33 42 41 30 10 01, 13 33"};
    case '4': return {"30 36 02 42"};
    case '5': return {"46 06 04 34 43 41 30 10 01"};
    case '6': return {"45 36 16 05 01 10 30 41 42 33 13 02"};
    case '7': return {"06 46 10"};
    case '8': return {"13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33"};
    case '9': return {"01 10 30 41 45 36 16 05 04 13 33 44"};
    case 'a': return {"04 34 43 40 10 01 12 42"};
    case 'b': return {"06 00 30 41 43 34 04"};
    case 'c': return {"43 34 14 03 01 10 30 41"};
    case 'd': return {"46 40 10 01 03 14 44"};
    case 'e': return {"02 42 43 34 14 03 01 10 30 41"};
    case 'f': return {"36 26 15 10, 04 24", 5};
    case 'g': return {"44 14 03 01 10 40, 44 4a 3b 1b"};
    case 'h': return {"06 00, 04 34 43 40"};
    case 'i': return {"04 00, 06 06", 2.5};
    case 'j': return {"14 1a 0b, 16 16", 3.5};
    case 'k': return {"00 06, 02 34, 13 30"};
    case 'l': return {"06 01 10", 3.5};
    case 'm': return {"00 04, 03 14 24 23 20, 23 34 44 43 40"};
    case 'n': return {"00 04, 03 14 34 43 40"};
    case 'o': return {"10 30 41 43 34 14 03 01 10"};
    case 'p': return {"04 0b, 04 34 43 41 30 00"};
    case 'q': return {"44 4b, 44 14 03 01 10 40"};
    case 'r': return {"04 00, 03 14 34", 5};
    case 's': return {"43 34 14 03 12 32 41 30 10 01"};
    case 't': return {"16 11 20 30, 04 34", 5};
    case 'u': return {"04 01 10 30 41, 44 40"};
    case 'v': return {"04 20 44"};
    case 'w': return {"04 10 24 30 44"};
    case 'x': return {"04 40, 00 44"};
    case 'y': return {"04 20, 44 1b 0b"};
    case 'z': return {"04 44 00 40"};
    case 'A': return {"00 26 40, 12 32"};
    case 'B': return {"00 06 36 45 44 33 42 41 30 00, 03 33"};
    case 'C': return {"45 36 16 05 01 10 30 41"};
    case 'D': return {"00 06 26 45 41 20 00"};
    case 'E': return {"46 06 00 40, 03 33"};
    case 'F': return {"46 06 00, 03 33"};
    case 'G': return {"45 36 16 05 01 10 30 41 43 23"};
    case 'H': return {"06 00, 46 40, 03 43"};
    case 'I': return {"06 26, 16 10, 00 20", 4};
    case 'J': return {"46 41 30 10 01"};
    case 'K': return {"06 00, 46 02, 24 40"};
    case 'L': return {"06 00 40"};
    case 'M': return {"00 06 23 46 40"};
    case 'N': return {"00 06 40 46"};
    case 'O': return {"10 30 41 45 36 16 05 01 10"};
    case 'P': return {"00 06 36 45 44 33 03"};
    case 'Q': return {"10 30 41 45 36 16 05 01 10, 22 40"};
    case 'R': return {"00 06 36 45 44 33 03, 23 40"};
    case 'S': return {"45 36 16 05 04 13 33 42 41 30 10 01"};
    case 'T': return {"06 46, 26 20"};
    case 'U': return {"06 01 10 30 41 46"};
    case 'V': return {"06 20 46"};
    case 'W': return {"06 10 24 30 46"};
    case 'X': return {"06 40, 00 46"};
    case 'Y': return {"06 23 46, 23 20"};
    case 'Z': return {"06 46 00 40"};
    case ' ': return {"", 3};
    case '.': return {"10 10", 3};
    case ',': return {"11 10 0a", 3};
    case ':': return {"10 10, 13 13", 3};
    case ';': return {"11 10 0a, 13 13", 3};
    case '!': return {"06 02, 00 00", 3};
    case '?': return {"05 16 36 45 44 23 22, 20 20"};
    case '\'': return {"06 04", 2.5};
    case '"': return {"06 04, 26 24", 4};
    case '-': return {"03 33", 5};
    case '+': return {"03 43, 21 25"};
    case '=': return {"02 42, 04 44"};
    case '_': return {"0a 4a"};
    case '/': return {"00 46"};
    case '\\': return {"06 40"};
    case '|': return {"06 0a", 2.5};
    case '(': return {"16 05 01 10", 3.5};
    case ')': return {"06 15 11 00", 3.5};
    case '[': return {"16 06 00 10", 3.5};
    case ']': return {"06 16 10 00", 3.5};
    case '{': return {"26 15 14 03 12 11 20", 4};
    case '}': return {"06 15 14 23 12 11 00", 4};
    case '<': return {"45 03 41"};
    case '>': return {"05 43 01"};
    case '%': return {"00 46, 05 05, 41 41"};
    case '*': return {"21 25, 02 44, 42 04"};
    case '^': return {"04 26 44"};
    case '~': return {"03 14 32 43"};
    case '#': return {"10 16, 30 36, 02 42, 04 44"};
    case '&': return {"40 05 16 25 02 01 10 20 42"};
    case '@': return {"32 34 14 12 42 45 36 16 05 01 10 40"};
    case '$': return {"45 05 04 13 33 42 41 01, 26 20"};
    case '`': return {"06 15", 2.5};
    default: return {"00 06 46 40 00"};
  }
}
// clang-format on

/// Whether a byte is not the first one of a UTF-8 character. Such bytes draw nothing, so that a character
/// outside ASCII is drawn as only one box.
bool goes_on(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

Vec2 grid_point(std::string_view two) {
  const double below = two[1] == 'a' ? -1 : -2;
  const bool hangs = two[1] == 'a' || two[1] == 'b';
  return {static_cast<double>(two[0] - '0'), hangs ? below : static_cast<double>(two[1] - '0')};
}

}  // namespace

void add_text(Lines& lines, std::string_view text, const Vec2& pen, double unit) {
  Vec2 at = pen;
  for (const char c : text) {
    if (goes_on(c)) continue;
    const Glyph letter = glyph(c);
    const std::string_view points = letter.points;
    const auto corner = [&](std::size_t i) -> Vec2 { return at + unit * grid_point(points.substr(i, 2)); };
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
      if (points[i + 2] == ',')
        ++i;  // the polyline ends here
      else
        lines.emplace_back(corner(i), corner(i + 3));
    }
    at.x() += unit * letter.advance;
  }
}

double text_width(std::string_view text, double unit) {
  double width = 0;
  for (const char c : text)
    if (!goes_on(c)) width += glyph(c).advance;
  return unit * (width - 2);
}

Mesh mesh_of(const Writing& writing, double stroke, const Theme& theme) {
  Mesh mesh = writing.under;
  Lines lines = writing.lines;
  for (const Text& text : writing.texts) {
    const double width = text.ends_at_pen ? text_width(text.text, text.unit) : 0;
    add_text(lines, text.text, text.pen - Vec2(width, 0), text.unit);
  }
  for (const auto& [a, b] : lines) add_stroke(mesh, a, b, 0, k_halo_strokes * stroke, Paint::own, theme.halo);
  for (const auto& [a, b] : lines) add_stroke(mesh, a, b, 0, k_ink_strokes * stroke, Paint::own, theme.ink);
  return mesh;
}

}  // namespace troupe::render
