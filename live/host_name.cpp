#include "live/host_name.hpp"

#include <algorithm>

namespace troupe::live {

std::string host_name(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::size_t colon = text.rfind(':');
  if (colon != text.npos && text.find(']', colon) == text.npos) {
    const std::string_view port = text.substr(colon + 1);
    if (port.empty() || !std::ranges::all_of(port, is_digit)) return {};
    text = text.substr(0, colon);
  }
  std::string name(text);
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  constexpr std::string_view k_others = ".-_[]:";
  const bool is_name = std::ranges::all_of(name, [&](char c) {
    return (c >= 'a' && c <= 'z') || is_digit(c) || k_others.find(c) != k_others.npos;
  });
  return is_name ? name : std::string();
}

}  // namespace troupe::live
