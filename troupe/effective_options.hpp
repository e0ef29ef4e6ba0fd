#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace troupe {

/// Returns true if an option of Simulation::effective_options() does not affect the simulated results. Such
/// options state how the run is computed (for example the number of threads) and at which tick it was
/// resumed. option: the key of the option.
constexpr bool changes_no_result(std::string_view option) {
  constexpr std::array<std::string_view, 5> k_options{"threads", "tile_m", "simd", "ranks",
                                                      "resumed_at_tick"};
  return std::ranges::find(k_options, option) != k_options.end();
}

/// Returns the first part of a line of version_line(), such as `troupe 0.2.0`.
constexpr std::string_view program_of(std::string_view line) { return line.substr(0, line.find(" (")); }

/// Returns `text` as one line: each line break is replaced by the two characters `\n`, and each backslash by
/// `\\`. Hash logs (files with the hash of the simulated state after every time step) contain the options of
/// the run in this form.
inline std::string to_one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n' || c == '\\') line += '\\';
    line += c == '\n' ? 'n' : c;
  }
  return line;
}

/// Returns the text from which to_one_line() made `line`.
inline std::string from_one_line(std::string_view line) {
  std::string text;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool is_escape = line[i] == '\\' && i + 1 < line.size();
    if (is_escape) ++i;
    text += is_escape && line[i] == 'n' ? '\n' : line[i];
  }
  return text;
}

}  // namespace troupe
