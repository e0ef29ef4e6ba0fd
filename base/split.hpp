#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

/// Divides a text at each separator. Returns the parts in their order, without the separators. Parts may be
/// empty: `a,,b` has three parts, and an empty text has one empty part. The parts refer to the characters of
/// `text`, which must outlive them.
inline std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

/// Returns the texts of a list one after another, with `separator` between them; empty without texts. It
/// takes the place of fmt::join(), for which each source that uses it would compile a part of fmt again.
template <class Texts>
std::string joined(const Texts& texts, std::string_view separator) {
  std::string all;
  std::string_view between;
  for (const std::string_view text : texts) {
    all.append(between).append(text);
    between = separator;
  }
  return all;
}

}  // namespace troupe
