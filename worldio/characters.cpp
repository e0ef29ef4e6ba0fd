#include "worldio/characters.hpp"

#include "base/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace troupe::worldio {
namespace {

std::uint8_t byte_at(std::string_view text, std::size_t at) { return static_cast<std::uint8_t>(text[at]); }

char32_t code_point(std::string_view text, std::size_t at, std::size_t length) {
  char32_t code = byte_at(text, at) & (0x7f >> length);
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte_at(text, at + i) & 0x3f);
  return code;
}

constexpr std::array<char32_t, 10> k_quotes{0xab,   0xbb,   0x2018, 0x2019, 0x201a,
                                            0x201b, 0x201c, 0x201d, 0x201e, 0x201f};
constexpr std::array<char32_t, 5> k_dashes{0x2010, 0x2011, 0x2013, 0x2014, 0x2212};
constexpr std::array<char32_t, 6> k_blanks{0xa0, 0x2007, 0x2009, 0x202f, 0x3000, 0xfeff};

template <std::size_t N>
bool is_one_of(const std::array<char32_t, N>& all, char32_t code) {
  return std::ranges::find(all, code) != all.end();
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

bool is_utf16(std::string_view text) {
  if (text.size() < 2) return false;
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return true;
  return (text[0] == '\0') != (text[1] == '\0');
}

std::string latin1_to_utf8(std::string_view text) {
  std::string converted;
  for (const char c : text) {
    const auto byte = static_cast<std::uint8_t>(c);
    if (byte < 0x80) {
      converted += c;
    } else {
      converted += static_cast<char>(0xc0 | byte >> 6);
      converted += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return converted;
}

std::string lines_in_utf8(std::string text) {
  if (is_utf8(text)) return text;
  std::string converted;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size() - 1) + 1;
    const std::string_view line = rest.substr(0, end);
    converted += is_utf8(line) ? std::string(line) : latin1_to_utf8(line);
    rest.remove_prefix(end);
  }
  return converted;
}

StrayCharacter stray_character(std::string_view text, std::size_t at, std::string_view where) {
  const std::size_t length = utf8_length(text.substr(at));
  if (length == 0)
    return {1,
            fmt::format("unexpected byte 0x{:02x}: this byte may be only in {}", byte_at(text, at), where)};
  const char32_t code = code_point(text, at, length);
  const std::string_view shown = text.substr(at, length);
  if (is_one_of(k_quotes, code))
    return {length, fmt::format("unexpected quotation mark {}: write the straight one, \"", shown)};
  if (is_one_of(k_dashes, code))
    return {length, fmt::format("unexpected dash {}: write the minus sign of ASCII, -", shown)};
  const auto number = static_cast<std::uint32_t>(code);
  if (is_one_of(k_blanks, code))
    return {length, fmt::format("unexpected blank U+{:04X}: write an ordinary blank", number)};
  return {length,
          fmt::format("unexpected character U+{:04X} ({}): it may be only in {}", number, shown, where)};
}

}  // namespace troupe::worldio
