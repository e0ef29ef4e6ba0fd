#include "base/printable.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace troupe {
namespace {

std::uint8_t byte_at(std::string_view text, std::size_t i) { return static_cast<std::uint8_t>(text[i]); }

std::string escaped(std::string_view text, bool keeps_lines) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t bytes = 0; !text.empty(); text.remove_prefix(bytes)) {
    const std::size_t length = utf8_length(text);
    bytes = length == 0 ? 1 : length;
    const std::uint8_t first = byte_at(text, 0);
    if (first == '\n' && !keeps_lines)
      out += "\\n";
    else if (first == '\r')
      out += "\\r";
    else if ((first < 0x20 && first != '\t' && first != '\n') || first == 0x7f ||
             (length == 0 && first >= 0x80 && first < 0xa0))
      out += fmt::format("\\x{:02x}", first);
    else if (first == 0xc2 && bytes == 2 && byte_at(text, 1) < 0xa0)
      out += fmt::format("\\u{:04x}", byte_at(text, 1));
    else
      out += text.substr(0, bytes);
  }
  return out;
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
  const std::uint8_t first = byte_at(text, 0);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte_at(text, i) & 0xc0) != 0x80) return 0;
  const std::uint8_t second = byte_at(text, 1);
  const bool is_wrong = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
                        (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f);
  return is_wrong ? 0 : length;
}

std::string printable(std::string_view text) { return escaped(text, true); }
std::string printable_line(std::string_view text) { return escaped(text, false); }

}  // namespace troupe
