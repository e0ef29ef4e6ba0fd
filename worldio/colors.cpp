#include "worldio/colors.hpp"

#include "base/number_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace troupe::worldio {
namespace {

struct Named {
  std::string_view name;
  std::uint32_t rgb;
};

struct Shades {
  std::string_view name;
  std::array<std::uint32_t, 5> rgb;  // the shade without a number, then the shades 1 to 4
};

// k_plain and k_shaded are sorted by name. They do not contain gray0 to gray100, which color_by_name()
// computes.
constexpr auto k_plain = std::to_array<Named>({
    {"AliceBlue", 0xf0f8ff},
    {"BlanchedAlmond", 0xffebcd},
    {"BlueViolet", 0x8a2be2},
    {"CornflowerBlue", 0x6495ed},
    {"DarkBlue", 0x00008b},
    {"DarkCyan", 0x008b8b},
    {"DarkGray", 0xa9a9a9},
    {"DarkGreen", 0x006400},
    {"DarkKhaki", 0xbdb76b},
    {"DarkMagenta", 0x8b008b},
    {"DarkRed", 0x8b0000},
    {"DarkSalmon", 0xe9967a},
    {"DarkSlateBlue", 0x483d8b},
    {"DarkTurquoise", 0x00ced1},
    {"DarkViolet", 0x9400d3},
    {"DimGray", 0x696969},
    {"FloralWhite", 0xfffaf0},
    {"ForestGreen", 0x228b22},
    {"GhostWhite", 0xf8f8ff},
    {"GreenYellow", 0xadff2f},
    {"LawnGreen", 0x7cfc00},
    {"LightCoral", 0xf08080},
    {"LightGoldenrodYellow", 0xfafad2},
    {"LightGray", 0xd3d3d3},
    {"LightGreen", 0x90ee90},
    {"LightSeaGreen", 0x20b2aa},
    {"LightSlateBlue", 0x8470ff},
    {"LightSlateGray", 0x778899},
    {"LimeGreen", 0x32cd32},
    {"MediumAquamarine", 0x66cdaa},
    {"MediumBlue", 0x0000cd},
    {"MediumSeaGreen", 0x3cb371},
    {"MediumSlateBlue", 0x7b68ee},
    {"MediumSpringGreen", 0x00fa9a},
    {"MediumTurquoise", 0x48d1cc},
    {"MediumVioletRed", 0xc71585},
    {"MidnightBlue", 0x191970},
    {"MintCream", 0xf5fffa},
    {"NavyBlue", 0x000080},
    {"OldLace", 0xfdf5e6},
    {"PaleGoldenrod", 0xeee8aa},
    {"PapayaWhip", 0xffefd5},
    {"PowderBlue", 0xb0e0e6},
    {"SaddleBrown", 0x8b4513},
    {"SandyBrown", 0xf4a460},
    {"WhiteSmoke", 0xf5f5f5},
    {"YellowGreen", 0x9acd32},
    {"beige", 0xf5f5dc},
    {"black", 0x000000},
    {"gainsboro", 0xdcdcdc},
    {"gray", 0xbebebe},
    {"lavender", 0xe6e6fa},
    {"linen", 0xfaf0e6},
    {"moccasin", 0xffe4b5},
    {"navy", 0x000080},
    {"peru", 0xcd853f},
    {"violet", 0xee82ee},
    {"white", 0xffffff},
});

constexpr auto k_shaded = std::to_array<Shades>({
    {"AntiqueWhite", {0xfaebd7, 0xffefdb, 0xeedfcc, 0xcdc0b0, 0x8b8378}},
    {"CadetBlue", {0x5f9ea0, 0x98f5ff, 0x8ee5ee, 0x7ac5cd, 0x53868b}},
    {"DarkGoldenrod", {0xb8860b, 0xffb90f, 0xeead0e, 0xcd950c, 0x8b6508}},
    {"DarkOliveGreen", {0x556b2f, 0xcaff70, 0xbcee68, 0xa2cd5a, 0x6e8b3d}},
    {"DarkOrange", {0xff8c00, 0xff7f00, 0xee7600, 0xcd6600, 0x8b4500}},
    {"DarkOrchid", {0x9932cc, 0xbf3eff, 0xb23aee, 0x9a32cd, 0x68228b}},
    {"DarkSeaGreen", {0x8fbc8f, 0xc1ffc1, 0xb4eeb4, 0x9bcd9b, 0x698b69}},
    {"DarkSlateGray", {0x2f4f4f, 0x97ffff, 0x8deeee, 0x79cdcd, 0x528b8b}},
    {"DeepPink", {0xff1493, 0xff1493, 0xee1289, 0xcd1076, 0x8b0a50}},
    {"DeepSkyBlue", {0x00bfff, 0x00bfff, 0x00b2ee, 0x009acd, 0x00688b}},
    {"DodgerBlue", {0x1e90ff, 0x1e90ff, 0x1c86ee, 0x1874cd, 0x104e8b}},
    {"HotPink", {0xff69b4, 0xff6eb4, 0xee6aa7, 0xcd6090, 0x8b3a62}},
    {"IndianRed", {0xcd5c5c, 0xff6a6a, 0xee6363, 0xcd5555, 0x8b3a3a}},
    {"LavenderBlush", {0xfff0f5, 0xfff0f5, 0xeee0e5, 0xcdc1c5, 0x8b8386}},
    {"LemonChiffon", {0xfffacd, 0xfffacd, 0xeee9bf, 0xcdc9a5, 0x8b8970}},
    {"LightBlue", {0xadd8e6, 0xbfefff, 0xb2dfee, 0x9ac0cd, 0x68838b}},
    {"LightCyan", {0xe0ffff, 0xe0ffff, 0xd1eeee, 0xb4cdcd, 0x7a8b8b}},
    {"LightGoldenrod", {0xeedd82, 0xffec8b, 0xeedc82, 0xcdbe70, 0x8b814c}},
    {"LightPink", {0xffb6c1, 0xffaeb9, 0xeea2ad, 0xcd8c95, 0x8b5f65}},
    {"LightSalmon", {0xffa07a, 0xffa07a, 0xee9572, 0xcd8162, 0x8b5742}},
    {"LightSkyBlue", {0x87cefa, 0xb0e2ff, 0xa4d3ee, 0x8db6cd, 0x607b8b}},
    {"LightSteelBlue", {0xb0c4de, 0xcae1ff, 0xbcd2ee, 0xa2b5cd, 0x6e7b8b}},
    {"LightYellow", {0xffffe0, 0xffffe0, 0xeeeed1, 0xcdcdb4, 0x8b8b7a}},
    {"MediumOrchid", {0xba55d3, 0xe066ff, 0xd15fee, 0xb452cd, 0x7a378b}},
    {"MediumPurple", {0x9370db, 0xab82ff, 0x9f79ee, 0x8968cd, 0x5d478b}},
    {"MistyRose", {0xffe4e1, 0xffe4e1, 0xeed5d2, 0xcdb7b5, 0x8b7d7b}},
    {"NavajoWhite", {0xffdead, 0xffdead, 0xeecfa1, 0xcdb38b, 0x8b795e}},
    {"OliveDrab", {0x6b8e23, 0xc0ff3e, 0xb3ee3a, 0x9acd32, 0x698b22}},
    {"OrangeRed", {0xff4500, 0xff4500, 0xee4000, 0xcd3700, 0x8b2500}},
    {"PaleGreen", {0x98fb98, 0x9aff9a, 0x90ee90, 0x7ccd7c, 0x548b54}},
    {"PaleTurquoise", {0xafeeee, 0xbbffff, 0xaeeeee, 0x96cdcd, 0x668b8b}},
    {"PaleVioletRed", {0xdb7093, 0xff82ab, 0xee799f, 0xcd6889, 0x8b475d}},
    {"PeachPuff", {0xffdab9, 0xffdab9, 0xeecbad, 0xcdaf95, 0x8b7765}},
    {"RosyBrown", {0xbc8f8f, 0xffc1c1, 0xeeb4b4, 0xcd9b9b, 0x8b6969}},
    {"RoyalBlue", {0x4169e1, 0x4876ff, 0x436eee, 0x3a5fcd, 0x27408b}},
    {"SeaGreen", {0x2e8b57, 0x54ff9f, 0x4eee94, 0x43cd80, 0x2e8b57}},
    {"SkyBlue", {0x87ceeb, 0x87ceff, 0x7ec0ee, 0x6ca6cd, 0x4a708b}},
    {"SlateBlue", {0x6a5acd, 0x836fff, 0x7a67ee, 0x6959cd, 0x473c8b}},
    {"SlateGray", {0x708090, 0xc6e2ff, 0xb9d3ee, 0x9fb6cd, 0x6c7b8b}},
    {"SpringGreen", {0x00ff7f, 0x00ff7f, 0x00ee76, 0x00cd66, 0x008b45}},
    {"SteelBlue", {0x4682b4, 0x63b8ff, 0x5cacee, 0x4f94cd, 0x36648b}},
    {"VioletRed", {0xd02090, 0xff3e96, 0xee3a8c, 0xcd3278, 0x8b2252}},
    {"aquamarine", {0x7fffd4, 0x7fffd4, 0x76eec6, 0x66cdaa, 0x458b74}},
    {"azure", {0xf0ffff, 0xf0ffff, 0xe0eeee, 0xc1cdcd, 0x838b8b}},
    {"bisque", {0xffe4c4, 0xffe4c4, 0xeed5b7, 0xcdb79e, 0x8b7d6b}},
    {"blue", {0x0000ff, 0x0000ff, 0x0000ee, 0x0000cd, 0x00008b}},
    {"brown", {0xa52a2a, 0xff4040, 0xee3b3b, 0xcd3333, 0x8b2323}},
    {"burlywood", {0xdeb887, 0xffd39b, 0xeec591, 0xcdaa7d, 0x8b7355}},
    {"chartreuse", {0x7fff00, 0x7fff00, 0x76ee00, 0x66cd00, 0x458b00}},
    {"chocolate", {0xd2691e, 0xff7f24, 0xee7621, 0xcd661d, 0x8b4513}},
    {"coral", {0xff7f50, 0xff7256, 0xee6a50, 0xcd5b45, 0x8b3e2f}},
    {"cornsilk", {0xfff8dc, 0xfff8dc, 0xeee8cd, 0xcdc8b1, 0x8b8878}},
    {"cyan", {0x00ffff, 0x00ffff, 0x00eeee, 0x00cdcd, 0x008b8b}},
    {"firebrick", {0xb22222, 0xff3030, 0xee2c2c, 0xcd2626, 0x8b1a1a}},
    {"gold", {0xffd700, 0xffd700, 0xeec900, 0xcdad00, 0x8b7500}},
    {"goldenrod", {0xdaa520, 0xffc125, 0xeeb422, 0xcd9b1d, 0x8b6914}},
    {"green", {0x00ff00, 0x00ff00, 0x00ee00, 0x00cd00, 0x008b00}},
    {"honeydew", {0xf0fff0, 0xf0fff0, 0xe0eee0, 0xc1cdc1, 0x838b83}},
    {"ivory", {0xfffff0, 0xfffff0, 0xeeeee0, 0xcdcdc1, 0x8b8b83}},
    {"khaki", {0xf0e68c, 0xfff68f, 0xeee685, 0xcdc673, 0x8b864e}},
    {"magenta", {0xff00ff, 0xff00ff, 0xee00ee, 0xcd00cd, 0x8b008b}},
    {"maroon", {0xb03060, 0xff34b3, 0xee30a7, 0xcd2990, 0x8b1c62}},
    {"orange", {0xffa500, 0xffa500, 0xee9a00, 0xcd8500, 0x8b5a00}},
    {"orchid", {0xda70d6, 0xff83fa, 0xee7ae9, 0xcd69c9, 0x8b4789}},
    {"pink", {0xffc0cb, 0xffb5c5, 0xeea9b8, 0xcd919e, 0x8b636c}},
    {"plum", {0xdda0dd, 0xffbbff, 0xeeaeee, 0xcd96cd, 0x8b668b}},
    {"purple", {0xa020f0, 0x9b30ff, 0x912cee, 0x7d26cd, 0x551a8b}},
    {"red", {0xff0000, 0xff0000, 0xee0000, 0xcd0000, 0x8b0000}},
    {"salmon", {0xfa8072, 0xff8c69, 0xee8262, 0xcd7054, 0x8b4c39}},
    {"seashell", {0xfff5ee, 0xfff5ee, 0xeee5de, 0xcdc5bf, 0x8b8682}},
    {"sienna", {0xa0522d, 0xff8247, 0xee7942, 0xcd6839, 0x8b4726}},
    {"snow", {0xfffafa, 0xfffafa, 0xeee9e9, 0xcdc9c9, 0x8b8989}},
    {"tan", {0xd2b48c, 0xffa54f, 0xee9a49, 0xcd853f, 0x8b5a2b}},
    {"thistle", {0xd8bfd8, 0xffe1ff, 0xeed2ee, 0xcdb5cd, 0x8b7b8b}},
    {"tomato", {0xff6347, 0xff6347, 0xee5c42, 0xcd4f39, 0x8b3626}},
    {"turquoise", {0x40e0d0, 0x00f5ff, 0x00e5ee, 0x00c5cd, 0x00868b}},
    {"wheat", {0xf5deb3, 0xffe7ba, 0xeed8ae, 0xcdba96, 0x8b7e66}},
    {"yellow", {0xffff00, 0xffff00, 0xeeee00, 0xcdcd00, 0x8b8b00}},
});

Color color_of(std::uint32_t rgb) {
  const auto part = [rgb](int shift) { return static_cast<float>((rgb >> shift) & 0xffu) / 255.0f; };
  return {part(16), part(8), part(0), 1};
}

template <class Table>
auto find(const Table& table, std::string_view name) {
  const auto it = std::ranges::lower_bound(table, name, {}, &Table::value_type::name);
  return it != table.end() && it->name == name ? &*it : nullptr;
}

/// Converts a name to its spelling in the tables: "dark slate grey" becomes "DarkSlateGray". X11 lists names
/// of several words in both spellings.
std::string canonical(std::string_view name) {
  std::string out;
  const bool words = name.find(' ') != std::string_view::npos;
  bool start = words;
  for (const char c : name) {
    if (c == ' ') {
      start = true;
    } else {
      // std::toupper() depends on the locale: in a Turkish one, the capital of i is not I.
      out += start && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
      start = false;
    }
  }
  for (const std::string_view grey : {"grey", "Grey"})
    if (const std::size_t at = out.find(grey); at != std::string::npos) out[at + 2] = 'a';
  return out;
}

}  // namespace

std::optional<Color> color_by_name(std::string_view given) {
  const std::string name = canonical(given);
  if (const Named* plain = find(k_plain, name)) return color_of(plain->rgb);
  if (const Shades* shades = find(k_shaded, name)) return color_of(shades->rgb[0]);

  const std::size_t digits = name.find_first_of("0123456789");
  if (digits == 0 || digits == std::string::npos || (name[digits] == '0' && name.size() > digits + 1))
    return {};
  const std::string_view stem = std::string_view(name).substr(0, digits);
  const std::optional<std::uint32_t> found = number_of<std::uint32_t>(std::string_view(name).substr(digits));
  if (!found) return {};
  const std::uint32_t number = *found;
  if (stem == "gray") {
    if (number > 100) return {};
    // X11's list rounds halves up, except for gray50 and gray90.
    const std::uint32_t level = (number * 255 + 50) / 100 - (number == 50 || number == 90);
    return color_of(level << 16 | level << 8 | level);
  }
  const Shades* shades = find(k_shaded, stem);
  if (!shades || number < 1 || number > 4) return {};
  return color_of(shades->rgb[number]);
}

std::span<const std::string_view> color_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const Named& plain : k_plain) all.push_back(plain.name);
    for (const Shades& shades : k_shaded) all.push_back(shades.name);
    std::ranges::sort(all);
    return all;
  }();
  return names;
}

std::vector<Color> default_colors(std::span<const engine::TypeSpec> types) {
  constexpr auto k_palette =
      std::to_array<std::uint32_t>({0x0072b2, 0xe69f00, 0x009e73, 0xd55e00, 0x56b4e9, 0xcc79a7, 0xf0e442});
  const auto is_wall = [](const engine::TypeSpec& type) {
    return !type.drive && type.devices.empty() && type.controllers.empty() &&
           std::ranges::none_of(type.parts, [](const engine::PartSpec& part) {
             return part.returns.pushable || part.returns.gripper;
           });
  };
  std::vector<Color> colors;
  std::size_t next = 0;
  for (const engine::TypeSpec& type : types) {
    if (is_wall(type)) {
      colors.push_back(k_wall_color);
      continue;
    }
    const std::uint32_t rgb = k_palette[next++ % k_palette.size()];
    const auto part = [rgb](int shift) { return static_cast<float>(rgb >> shift & 0xffU) / 255; };
    colors.push_back({part(16), part(8), part(0), 1});
  }
  return colors;
}

}  // namespace troupe::worldio
